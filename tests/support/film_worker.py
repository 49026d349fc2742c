"""Runs the C++ `volpath` of `scalar_rgb` on a folder's scenes, in a process of its own: a process has one variant.

Usage: film_worker.py FOLDER; each NAME.xml gets a NAME.npy beside it, (layers, PASSES, SIDE, SIDE, 3).
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from reference.film_volpath import FilmVolpath
from scenes.loader import load

PASSES, SIDE, SAMPLES = 8, 4, 512


class ManySamples(FilmVolpath):
    """Passes that are long enough for their means to be near to Gaussian."""

    SAMPLES = SAMPLES


def main(folder: Path) -> None:
    """Estimate every scene of a folder."""
    for number, path in enumerate(sorted(folder.glob("*.xml"))):
        estimator = ManySamples(load(path, size=(SIDE, SIDE)))
        # seeds of its own for each scene
        passes = [estimator.one_pass(seed) for seed in range(number * PASSES, (number + 1) * PASSES)]
        np.save(path.with_suffix(".npy"), [[images[layer] for images in passes] for layer in ManySamples.layers])


if __name__ == "__main__":
    main(Path(sys.argv[1]))
