"""The parts of a technique that err, which of them a technique has, and the cell that replaces some of them.

The exact control of each part:

- airlight model: `quadrature`;
- visibility: `exact`, every crossing of the ray through the technique's own shadow map;
- shadow map: the technique's own visibility, its lookups answered by the reference's shadow rays;
- both of the two: `given`, the reference's lit intervals;
- lattice, with its reconstruction: every pixel;
- float32: the pieces that the visibility reported, evaluated and summed in float64 (float64.py). Where a strategy
  places its pieces is computed in float32 all the same, and stays the visibility's.

A model that samples points is as accurate as the pieces are short, and would not be itself on those of an exact
visibility, which go from one shadow to the next: there it gets them in the technique's steps (`exact:steps` and
`given:steps`).

Rays end where OpenGL has them end, those of the reference too (pictures.py). Where it sees another surface than the
reference does, at silhouettes, no part is charged with it: it stands in what remains.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from experiments.attribution.float64 import why_no_twin
from experiments.attribution.shapley import Coalition
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.techniques import Technique
from gpu_impl.visibilities import VISIBILITIES
from scenes.model import Scene

MODEL, VISIBILITY, SHADOW_MAP, LATTICE, FLOAT32 = PARTS = (
    "airlight model",
    "visibility",
    "shadow map",
    "lattice",
    "float32",
)
# the exact controls
EXACT_MODEL, EXACT_VISIBILITY, GIVEN_VISIBILITY, EVERY_PIXEL = "quadrature", "exact", "given", "grid"
# the variant of an exact visibility that reports its pieces cut into the technique's steps
IN_STEPS = ":steps"


@dataclass(frozen=True)
class Parts:
    """What of a technique can err.

    Attributes
    ----------
    there : tuple of str    names of `PARTS`, in their order
    left_out : dict         the others, each with the reason
    """

    there: tuple[str, ...]
    left_out: dict[str, str]


def parts_of(technique: Technique, scene: Scene) -> Parts:
    """Tell the parts that the technique has on a scene, and why it has not the others."""
    visibility = VISIBILITIES[technique.visibility]
    reasons = {
        MODEL: "the model is `quadrature` already" if technique.airlight == EXACT_MODEL else "",
        VISIBILITY: _why_no_visibility(technique),
        SHADOW_MAP: "" if visibility.reads_shadow_map else f"`{technique.visibility}` reads no shadow map",
        LATTICE: "every pixel is evaluated already" if _is_every_pixel(technique) else "",
        FLOAT32: "the model is evaluated at the corners of what the visibility draws, and interpolated"
        if visibility.airlight_at_corners
        else why_no_twin(technique.airlight, scene.phase),
    }
    if technique.shadow_source == "rays":
        reasons[SHADOW_MAP] = "the lookups are answered by the reference's rays already"
    there = tuple(part for part in PARTS if not reasons[part])
    return Parts(there, {part: reason for part, reason in reasons.items() if reason})


def _why_no_visibility(technique: Technique) -> str:
    if VISIBILITIES[technique.visibility].given:
        return "the visibility is the reference's already"
    return "the visibility is `exact` already" if technique.visibility == EXACT_VISIBILITY else ""


def _is_every_pixel(technique: Technique) -> bool:
    return technique.lattice == EVERY_PIXEL and technique.downsample == 1


def replaced(technique: Technique, coalition: Coalition) -> Technique:
    """The cell in which the parts of a coalition are exact; all but float32, which no setting changes."""
    changes: dict[str, object] = {}
    if MODEL in coalition:
        changes["airlight"] = EXACT_MODEL
    if LATTICE in coalition:
        changes |= {"lattice": EVERY_PIXEL, "downsample": 1}
    # whoever reads no map has no other exact visibility than the reference's
    exact = VISIBILITY in coalition or technique.visibility == EXACT_VISIBILITY
    without_map = SHADOW_MAP in coalition or not VISIBILITIES[technique.visibility].reads_shadow_map
    if exact and without_map:
        changes |= {"visibility": GIVEN_VISIBILITY, "shadow_source": "map"}
    elif exact:
        changes["visibility"] = EXACT_VISIBILITY
    elif SHADOW_MAP in coalition:
        changes["shadow_source"] = "rays"
    if AIRLIGHT_MODELS[technique.airlight].point_samples and VISIBILITY in coalition and MODEL not in coalition:
        changes["visibility"] = f"{changes['visibility']}{IN_STEPS}"
    if not changes:
        return technique
    cell = replace(technique, **changes)  # type: ignore[arg-type]
    return replace(cell, name=f"{cell.visibility}+{cell.airlight}")
