"""Writes a scene's export: scene.json, pixels.exr and a README.txt that says how to use them."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import numpy as np

from experiments.export.description import describe
from experiments.exr import write_exr
from experiments.exr_layers import Layers
from experiments.provenance import describe_files, describe_scene, scene_file
from scenes.errors import InputError
from scenes.file_names import check_name
from scenes.model import Scene
from scenes.replacing import make_folder, replacing

DESCRIPTION, PIXELS, TEXT = "scene.json", "pixels.exr", "README.txt"
TITLE = "Exported by airlight: "
CURE = "choose another --export"


def check_folder(folder: Path) -> None:
    """Make the folder before the work begins, and see that nothing in it would be lost.

    Raises
    ------
    InputError
        It cannot be made or written to, or one of the three names is there and no export of ours.
    """
    check_name(folder)
    make_folder(folder, CURE)
    text = folder / TEXT
    try:
        is_ours = text.is_file() and text.read_text(encoding="utf-8", errors="replace").startswith(TITLE)
    except OSError as error:
        raise InputError(f"{text} cannot be read ({error.strerror}): {CURE}.") from None
    for name in (DESCRIPTION, PIXELS, TEXT):
        if (folder / name).exists() and not is_ours:
            raise InputError(f"{folder / name} is of no export of ours, and would be lost: {CURE}.")


def write_export(folder: Path, scene: Scene) -> None:
    """Write the three files, each beside its place first and then renamed.

    Raises
    ------
    InputError
        They cannot be written, or Mitsuba has no variant that casts rays in packets.
    """
    check_folder(folder)
    layers = pixels(scene)
    # first what says that the others are ours
    _write(folder / TEXT, _text(scene))
    write_exr(folder / PIXELS, layers, describe_scene(scene) | describe_files(scene))
    _write(folder / DESCRIPTION, json.dumps(describe(scene), indent=1) + "\n")


def pixels(scene: Scene) -> Layers:
    """Where each pixel's ray ends, layers by name, float32; `_text` says what they are."""
    from reference.first_surfaces import first_surfaces

    found = first_surfaces(scene)
    origin, direction, _ = scene.camera.rays()
    before_near = np.linalg.norm(origin - scene.camera.origin, axis=-1)
    distance = found.depth + before_near
    along = np.einsum("hwi,i->hw", direction, scene.camera.to_world[:3, 2])
    layers = {
        "depth": found.depth,
        "distance": distance,
        "z": distance * along,
        "hit": found.hit,
        "normal": found.normal,
    }
    return {name: image.astype(np.float32) for name, image in layers.items()}


def _write(path: Path, text: str) -> None:
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8")


def _text(scene: Scene) -> str:
    camera = scene.camera
    parameters = [part for name, value in scene.parameters.items() for part in ("-p", f"{name}={value}")]
    size = ["--size", str(camera.width), str(camera.height)]
    command = shlex.join(["airlight", "reference", scene_file(scene), *parameters, *size, "--out", "reference.exr"])
    return f"""{TITLE}the scene {scene.name} at {camera.width} x {camera.height} pixels

{DESCRIPTION}   camera, fog, phase function and lights, with units and conventions beside the numbers; in its last table
             what made it. The surfaces themselves are those of the scene's file, a Mitsuba 3 XML.
{PIXELS}   for every pixel, row 0 at the top, float32:
               distance.Y   from the camera's position along the ray through the pixel's centre to the first surface,
                            or where there is none to the far plane [scene unit]
               z.Y          the same end's distance along the viewing axis [scene unit]
               depth.Z      from the near plane along the ray, as in the files of `airlight render` [scene unit]
               hit.Y        1 where there is a surface, 0 where the ray ends on the far plane
               normal.RGB   of the surface (x, y, z in world space, of the triangle itself and towards the eye), or 0

The ray through the centre of the pixel in column i and row j, both from 0:
    x = (2 i + 1) / width - 1
    y = 1 - (2 j + 1) / height
    direction = normalised(forward + x tan(fov_x / 2) right + y tan(fov_y / 2) up)
    end = position + distance direction

To compare a picture of your engine with the reference, save it as an EXR of the same size, with plain linear R, G, B:
    {command}
    airlight compare yours.exr reference.exr                        the whole picture
    airlight compare yours.exr reference.exr --layer scattering     the light of the fog alone
"""
