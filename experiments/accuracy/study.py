"""Errors of one technique against the deterministic reference, over samples a ray and texels of the shadow map."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from typing import Any

from experiments.metrics import measure
from experiments.provenance import describe_frame, describe_reference, describe_scene
from experiments.renderers import open_renderer
from gpu_impl.frame import Frame
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from reference.estimate import Reference, deterministic_reference
from scenes.loader import load
from scenes.model import Scene

Row = dict[str, Any]

SCENES = ("donut_dragon", "dragon", "yeahright", "many_objects", "wire_mesh")
PHASES: tuple[dict[str, object], ...] = ({"phase": "isotropic"}, {"phase": "rayleigh"}, {"phase": "hg", "g": 0.6})
# the settings at which a case is judged, and the largest errors at which it passes: median, 95th percentile
STEPS, SHADOW_MAP = 256, 2048
LIMITS = 0.02, 0.10
# layers to columns: their image mean as Eq. 14 is printed, over that of the physical composition, less 1
PRINTED = {"surface": "printed_surface_mean_rel", "composite": "printed_composite_mean_rel"}
# the phase function under which compositions are compared: a surface does not know which one the fog has
COMPARED = "isotropic"
# each ladder is climbed while the other setting is at its last rung
STEPS_LADDER = (16, 32, 64, 128, 256, 512, 1024)
SHADOW_MAP_LADDER = (128, 256, 512, 1024, 2048)


def study(
    scenes: Sequence[str], size: tuple[int, int], technique: str, tell: Callable[[str], None]
) -> Iterator[list[Row]]:
    """Draw each scene under each phase function with all settings; a row each, in a list a case.

    Parameters
    ----------
    technique : str    a name or a cell; its steps and its shadow map are set here
    tell : callable    told what is being done

    Raises
    ------
    InputError
        A scene or the technique cannot be used, which is said before the first reference is computed; or there is no
        usable LLVM for the references.
    """
    asked = find_technique(technique)
    cases = [(load(name, size=size, **parameters), phase_name(parameters)) for name in scenes for parameters in PHASES]
    for scene, _ in cases:
        asked.check_scene(scene)
    for scene, phase in cases:
        tell(f"{scene.name}, {phase}: reference")
        truth = deterministic_reference(scene)
        tell(f"{scene.name}, {phase}: {technique}")
        with open_renderer(scene) as renderer:
            yield [_row(renderer, scene, truth, technique, phase, *found) for found in settings()]


def settings() -> list[tuple[int, int]]:
    """Steps and shadow maps of a case, each pair once."""
    pairs = [(steps, SHADOW_MAP_LADDER[-1]) for steps in STEPS_LADDER]
    pairs += [(STEPS_LADDER[-1], shadow_map) for shadow_map in SHADOW_MAP_LADDER]
    return list(dict.fromkeys([(STEPS, SHADOW_MAP), *pairs]))


def judged(rows: Sequence[Row]) -> list[Row]:
    """The rows at the settings that the limits are for."""
    return [row for row in rows if (row["steps"], row["shadow_map"]) == (str(STEPS), str(SHADOW_MAP))]


def passes(row: Row) -> bool:
    """Whether a case keeps the limits."""
    return row["rel_50"] <= LIMITS[0] and row["rel_95"] <= LIMITS[1]


def phase_name(parameters: dict[str, object]) -> str:
    """A phase function with its parameter, for people."""
    return " ".join(map(str, parameters.values()))


def _row(
    renderer: Renderer, scene: Scene, truth: Reference, technique: str, phase: str, steps: int, shadow_map: int
) -> Row:
    frame = renderer.render(find_technique(technique, steps=steps, shadow_map=shadow_map))
    compared = phase == COMPARED and (steps, shadow_map) == (STEPS, SHADOW_MAP)
    metrics = measure(frame.scattering, truth.scattering)
    return {
        "scene": scene.name,
        "phase": phase,
        **asdict(metrics),
        **(_printed_over_physical(renderer, frame) if compared else dict.fromkeys(PRINTED.values())),
        **describe_scene(scene),
        **describe_frame(frame),
        **describe_reference(truth),
    }


def _printed_over_physical(renderer: Renderer, physical: Frame) -> dict[str, float | None]:
    """`PRINTED` of one picture; None of a layer that is black."""
    printed = renderer.render(replace(physical.technique, composition="printed"))
    means = {layer: tuple(getattr(one, layer).mean(dtype=float) for one in (printed, physical)) for layer in PRINTED}
    return {PRINTED[layer]: float(of / to - 1) if to > 0 else None for layer, (of, to) in means.items()}
