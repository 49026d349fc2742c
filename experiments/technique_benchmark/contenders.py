"""Who runs, who is compared with whom, and what the thesis says it reached."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from experiments.provenance import scene_file
from gpu_impl.techniques import Technique, find_technique
from scenes.errors import InputError
from scenes.messages import readable
from scenes.model import Scene

STEPS = 64
# as the published technique is drawn, all pixels evaluated
FULL = {"steps": STEPS, "shadow_map": 1024, "downsample": 1}
# the 95th percentile of yeahright's error (isotropic, 512 x 512) is 9.9 % with 512 texels and 10.2 % with 256
# what the limits of error below leave room for: fewer texels and plainer upsampling
FAST = {"steps": STEPS, "shadow_map": 256, "downsample": 4}
FASTER = FAST | {"upsample": "bilinear"}


@dataclass(frozen=True)
class Contender:
    """A technique with its settings, under the name that tables call it by."""

    name: str
    technique: str
    settings: dict[str, Any] = field(default_factory=lambda: FULL)

    def find(self) -> Technique:
        """Look the technique up; InputError where there is none of that name."""
        return find_technique(self.technique, **self.settings)


BASELINE = Contender("march", "Nishita1987")
CONTENDERS = (
    BASELINE,
    Contender("fast", "Weng2010", FAST),
    Contender("fast quadrature", "lit_intervals+quadrature", FAST),
    Contender("fast whole ray", "lit_intervals:unbounded+quadrature", FAST),
    Contender("fast whole ray bilinear", "lit_intervals:unbounded+quadrature", FASTER),
    Contender("repaired", "Weng2010"),
    Contender("merged", "lit_intervals+weng2010"),
    Contender("four Ei", "Weng2010:four-ei"),
    Contender("three Ei", "Weng2010:three-ei"),
    Contender("two Ei", "Weng2010:two-ei"),
    Contender("Taylor", "Weng2010:taylor"),
    Contender("minimax", "Weng2010:minimax"),
    Contender("as printed", "Weng2010:printed"),
    Contender("quadrature", "lit_intervals+quadrature"),
    Contender("whole ray with as many samples", "lit_intervals:unbounded+quadrature"),
    # it takes as many samples as give the spacing of "quadrature", scene by scene: see measurement.py
    Contender("whole ray as dense", "lit_intervals:unbounded+quadrature"),
    Contender("map in a buffer", "lit_intervals+quadrature", FULL | {"shadow_storage": "buffer"}),
)
FAST_ROWS = tuple(one.name for one in CONTENDERS if one.settings in (FAST, FASTER))
AS_DENSE, BOUNDED = "whole ray as dense", "quadrature"


@dataclass(frozen=True)
class Pair:
    """Two contenders that differ in one thing, and what the thesis says of it."""

    first: str
    second: str
    claim: str


PAIRS = (
    Pair("four Ei", "three Ei", "section 4.4: three evaluations of Ei for four"),
    Pair("three Ei", "two Ei", "section 4.4: two for three where the phase function is isotropic"),
    Pair("two Ei", "merged", "ours: the exponents merged into Ei"),
    Pair("whole ray with as many samples", "quadrature", "Algorithm 4.2: samples in the shadow region only, as many"),
    Pair("whole ray as dense", "quadrature", "Algorithm 4.2: samples in the shadow region only, as dense"),
    Pair("quadrature", "map in a buffer", "chapter 4: the shadow map in a buffer rather than a texture"),
)

# Weng 2010, Table 5.1: frames a second, anisotropic and isotropic, at 1024 x 1024 on a GeForce 9800 GT
TABLE_5_1 = {"donut_dragon": (6, 23), "dragon": (12, 24), "yeahright": (6, 17), "many_objects": (8, 18)}
SCENES = [*TABLE_5_1, "wire_mesh"]
# what a fast row's error may be: of the median pixel with airlight, and at the 95th percentile
ERROR_LIMITS = (0.05, 0.20)


def chosen(names: Sequence[str] | None) -> tuple[Contender, ...]:
    """The contenders of some names, and the baseline; all where none is named.

    Raises
    ------
    InputError
        A name is not known.
    """
    if not names:
        return CONTENDERS
    known = [one.name for one in CONTENDERS]
    for name in names:
        if name not in known:
            raise InputError(f"There is no contender '{readable(name)}'; use one of {', '.join(known)}.")
    # its samples are as dense as those of the bounded march
    wanted = {BASELINE.name, *names, *([BOUNDED] if AS_DENSE in names else [])}
    return tuple(one for one in CONTENDERS if one.name in wanted)


def published_rate(scene: Scene) -> int | None:
    """Frames a second that Table 5.1 has for a shipped scene; None where it has none, and for other people's scenes."""
    anisotropic, isotropic = TABLE_5_1.get(scene_file(scene), (None, None))
    return isotropic if scene.phase.name == "isotropic" else anisotropic
