"""Runs cases one after another and judges how each ended; a process of its own, as a case may end it."""

from __future__ import annotations

import dataclasses
import faulthandler
import json
import os
import re
import resource
import sys
import time
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path
from random import Random

sys.path.insert(0, str(Path(__file__).parent.parent / "support"))

import mesh_mutations
import mutations
import numpy as np
import seeds

from experiments.exr import read_exr
from experiments.pictures import write_frame
from gpu_impl.frame import Frame
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import Technique
from reference.estimators import default_estimator
from reference.mitsuba_scene import instantiate
from scenes.catalogue import shipped
from scenes.errors import InputError
from scenes.loader import load
from scenes.manifest import frozen_version
from scenes.model import Scene

TECHNIQUE = Technique("lit_intervals+quadrature", "lit_intervals", "quadrature", steps=16, shadow_map=64)
# one case in so many is also estimated, which compiles kernels of its own
REFERENCE_EVERY = 10
# one in so many is also written to a file; 7 has no factor in common with the others
WRITE_EVERY = 7
MOST_PIXELS = 64 * 64
MEMORY = 4 << 30
LONGEST_SENTENCE = 1500
SCENES = seeds.scenes()
PLAIN = seeds.plain_scene()
MESHES = seeds.meshes()
CODE = re.compile(r"Traceback|Error\(|Exception|<class|object at 0x|np\.|NoneType|\[[a-z_/]+\.(cpp|h|py):\d+\]|\\n")


class FaultError(Exception):
    """A case that ended as none may."""


def write_case(folder: Path, kind: str, number: int, seed: int) -> tuple[Path, list[Path]]:
    """Write a case's scene and whatever it spoils; the files, the scene first."""
    rng = Random(f"{seed}/{kind}/{number}")
    scene = folder / f"{kind}{number}.xml"
    if kind == "scene":
        text = SCENES[rng.choice(list(SCENES))]
        scene.write_bytes(mutations.spoil(text, rng).replace(b"SELF", scene.name.encode()))
        return scene, [scene]
    name = rng.choice(list(MESHES))
    mesh = folder / f"mesh{number}{Path(name).suffix}"
    mesh.write_bytes(mesh_mutations.spoil(name, MESHES[name], rng))
    plugin = mesh.suffix[1:]
    shape = f'<shape type="{plugin}"><string name="filename" value="{mesh.name}"/></shape></scene>'
    scene.write_text(PLAIN.replace("</scene>", shape), encoding="utf-8")
    return scene, [scene, mesh]


def run_case(path: Path, kind: str, number: int) -> str:
    """Load, draw, instantiate and, of some, estimate and write; "picture" or "sentence".

    Raises
    ------
    FaultError   the sentence is none, the picture has pixels that are not finite, or its file is not what was drawn
    """
    size = None if number % 5 == 0 else (16, 12)
    try:
        scene = load(path, size=size)
        if scene.camera.width * scene.camera.height > MOST_PIXELS:
            return "picture"
        with Renderer(scene) as renderer:
            frame = renderer.render(TECHNIQUE)
        instantiate(scene)
        if number % REFERENCE_EVERY == 0:
            _estimate(scene)
        if number % WRITE_EVERY == 0:
            _write(scene, frame)
    except InputError as error:
        _judge(str(error), path.parent)
        return "sentence"
    composite = frame.composite
    if composite.shape[2:] != (3,) or not np.isfinite(composite).all():
        raise FaultError(f"a picture of shape {composite.shape} with pixels that are not finite")
    return "picture"


def _estimate(scene: Scene) -> None:
    estimator = default_estimator()(scene)
    for layer, image in (estimator.fixed() | estimator.one_pass(1)).items():
        if not np.isfinite(image).all():
            raise FaultError(f"the reference's {layer} is not finite")


def _write(scene: Scene, frame: Frame) -> None:
    """Name the version as if the scene were one of the shipped ones; write what was drawn, and read it back."""
    version = frozen_version(dataclasses.replace(scene, name=shipped()[0]))
    if not version.startswith("unfrozen: "):
        raise FaultError(f"a spoilt scene is called {version}")
    path = scene.path.with_suffix(".exr")
    write_frame(path, scene, frame)
    layers, _ = read_exr(path)
    path.unlink()
    for name, image in frame.layers.items():
        if not np.array_equal(layers[name], image):
            raise FaultError(f"the EXR file's {name} is not what was drawn")


def _judge(sentence: str, folder: Path) -> None:
    """Hold a refusal against what people are promised: one sentence that names the file."""
    for what, wrong in (
        ("is empty", not sentence.strip()),
        ("has no full stop at its end", not sentence.endswith(".") or sentence.endswith("..")),
        ("has several lines or control characters", not sentence.isprintable()),
        ("names no file", str(folder) not in sentence),
        ("is very long", len(sentence) > LONGEST_SENTENCE),
        ("reads like code", CODE.search(sentence) is not None),
    ):
        if wrong:
            raise FaultError(f"the sentence {what}: {sentence[:600]!r}")


def _planted(number: int) -> str:
    """Faults of every kind, to see that they are noticed."""
    deeds: list[Callable[[], object]] = [
        os.abort,
        lambda: time.sleep(3600),
        lambda: 1 / 0,
        lambda: warnings.warn("fog", stacklevel=1),
        lambda: os.write(1, b"fog\n"),
        lambda: _judge("No", Path("/")),
        lambda: bytearray(2 * MEMORY),
    ]
    deeds[number]()
    return "picture"


def main(folder: Path, seed: int) -> None:
    """Say "ready"; then take cases from the standard input, a line each, and answer with a line of JSON each.

    What a case prints goes to the file `printed`, where it is looked for after each, and after the process has ended.
    """
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    printed = os.open(folder / "printed", os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_TRUNC)
    os.dup2(printed, 1)
    os.dup2(printed, 2)
    faulthandler.enable()
    seeds.write_files(folder)
    answers.write("ready\n")
    answers.flush()
    for line in sys.stdin:
        kind, number = line.split()[0], int(line.split()[1])
        os.ftruncate(printed, 0)
        begin = time.perf_counter()
        fault, end, files = "", "", []
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                if kind == "planted":
                    end = _planted(number)
                else:
                    path, files = write_case(folder, kind, number, seed)
                    end = run_case(path, kind, number)
            except FaultError as error:
                fault = str(error)
            except BaseException:
                fault = traceback.format_exc()
        if not fault and caught:
            fault = "warned: " + "; ".join(f"{w.filename}:{w.lineno} {w.category.__name__} {w.message}" for w in caught)
        sys.stdout.flush()
        if not fault and (size := os.fstat(printed).st_size):
            fault = "printed: " + os.pread(printed, min(size, 4000), 0).decode("utf-8", "replace")
        seconds = time.perf_counter() - begin
        answers.write(
            json.dumps({"kind": kind, "number": number, "end": end, "fault": fault, "seconds": seconds}) + "\n"
        )
        answers.flush()
        if not fault:
            for file in files:
                file.unlink()


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
