"""Draws the shipped scenes as small pictures, for scenes/README.md and for whoever wants to look at a scene.

    .venv/bin/python scripts/thumbnails.py
    .venv/bin/python scripts/thumbnails.py dragon slit --side 512 --out /tmp

The first draws all of them anew; AIRLIGHT_MESH_DIR should then name the folder of the meshes that the scenes mean.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from matplotlib.image import imsave

import airlight
from experiments.sheet import display
from experiments.terminal import announce_scene
from scenes.catalogue import FOLDER, shipped
from scenes.replacing import make_folder, replacing

# pixels drawn for each one shown, on a side: a wire is thinner than a pixel of a thumbnail
FINER = 4
TECHNIQUE, STEPS = "lit_intervals+quadrature", 256


def main() -> None:
    """Draw the scenes asked for."""
    parser = argparse.ArgumentParser(description="Draw shipped scenes as PNG pictures.")
    parser.add_argument("scene", nargs="*", help="names of shipped scenes; all by default")
    parser.add_argument("--side", type=int, default=192, help="width and height of a picture [pixel]")
    parser.add_argument("--out", type=Path, default=FOLDER / "thumbnails", help="folder that takes the pictures")
    asked = parser.parse_args()
    try:
        make_folder(asked.out, "choose another place with --out")
        for name in asked.scene or shipped():
            draw(name, asked.side, asked.out / f"{Path(name).stem}.png")
    except airlight.InputError as error:
        print(error, file=sys.stderr)
        raise SystemExit(2) from None


def draw(name: str, side: int, path: Path) -> None:
    """Write one scene's picture."""
    scene = airlight.load(name, size=(FINER * side, FINER * side))
    announce_scene(scene)
    image = airlight.render(scene, TECHNIQUE, steps=STEPS).composite
    shown = image.reshape(side, FINER, side, FINER, 3).mean(axis=(1, 3))
    with replacing(path) as beside:
        imsave(beside, display(shown, shown), format="png", pil_kwargs={"optimize": True})


if __name__ == "__main__":
    main()
