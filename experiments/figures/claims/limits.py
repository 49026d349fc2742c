"""Claims about where the method ends: what it finds dear, and what it refuses."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from experiments.figures.claims.claim import SAMPLES, SCENES, Claim, Finding, listed
from experiments.figures.interlaced import SCENE as WIRE_MESH
from experiments.figures.stage import Stage
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.techniques import find_technique
from scenes.errors import InputError

CLOSED_FORMS = tuple(name for name in AIRLIGHT_MODELS if name.startswith("weng2010"))


def _wire_mesh(stage: Stage) -> Finding:
    told, dearest = {}, []
    for technique in ("Weng2010:printed", "Weng2010:three-ei"):
        evaluations = {}
        for name in (WIRE_MESH, *SCENES):
            counts = stage.renderer(stage.scene(name)).counts(find_technique(technique, steps=SAMPLES))
            evaluated = counts["exponential_integrals"]
            evaluations[name] = float(evaluated[evaluated > 0].mean())
        dearest.append(evaluations[WIRE_MESH] == max(evaluations.values()))
        told[technique] = ", ".join(f"{name} {found:.2f}" for name, found in evaluations.items())
    return Finding(f"Evaluations of Ei a lit ray: {listed(told)}. They are counted, and exact.", *dearest)


def _point_and_spot(stage: Stage) -> Finding:
    takes: dict[Literal["point", "spot", "directional"], list[str]] = {"point": [], "spot": [], "directional": []}
    scene = stage.scene("donut_dragon")
    for kind, models in takes.items():
        lit = replace(scene, lights=tuple(replace(light, kind=kind) for light in scene.lights))
        for model in CLOSED_FORMS:
            try:
                find_technique(f"lit_intervals+{model}").check_scene(lit)
                models.append(model)
            except InputError:
                pass
    restricted = takes["point"] == takes["spot"] == list(CLOSED_FORMS) and not takes["directional"]
    told = {str(kind): f"{len(models)} of {len(CLOSED_FORMS)}" for kind, models in takes.items()}
    return Finding(
        f"Closed forms that take a light: {listed(told)}. It is what airlight's forms are written to take, of whose "
        "equations h, the distance of a light, is part; that no other closed form could do is not shown.",
        restricted,
        restricted,
    )


CLAIMS = (
    Claim(
        "If an object is complex like the wire mesh in a scene, the computation cost is expensive.",
        "38, 39",
        "Evaluations of Ei, as printed and repaired, in `wire_mesh` and in the four scenes. Reproduced if "
        "`wire_mesh` needs most a lit ray.",
        "5.4",
        _wire_mesh,
    ),
    Claim(
        "The radiative transport equation by Pegoraro et al. restricts us to point light or spotlight.",
        "39",
        "Whether the closed forms accept lights of each kind. Reproduced if all take points and spots, none a sun.",
        "",
        _point_and_spot,
    ),
)
