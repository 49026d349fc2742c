"""Errors planted on purpose, each in one part of a technique: the attribution must charge them to that part.

A planted error is the change from a technique to the same technique spoilt in one place. Both are split, and the part's
own share is its change over the sum of the changes of all parts, each counted positive: what leaks from one part to
another cannot cancel what leaks the other way.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from rich.table import Table
from rich.text import Text

from experiments.attribution.coalitions import LATTICE, MODEL, PARTS, SHADOW_MAP
from experiments.attribution.measurement import Attribution, attribute
from experiments.attribution.pictures import Pictures
from experiments.console import plain_table
from gpu_impl import shader_source
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.techniques import find_technique
from reference.estimate import deterministic_reference
from scenes.loader import load

# of the changes of all parts, the part's own must be more
LEAST = 0.8
# of the squared error before: where it changes by less, the changes of the parts are what they are for any other reason
LEAST_CHANGE = 0.5
SIZE = (48, 48)
FLIPPED = "quadrature:flipped-g"
# of the change by a shadow map of 128 x 128, in the part of that name, measured on the sphere: what a search or a march
# misses changes with the map's texels too, and what the two do together is shared out
SHADOW_MAPS = (
    "it has 87 % of what 128 x 128 texels do to Weng2010, 80 % with lit_intervals:unbounded+one_ei at 1024 steps, 66 % "
    "with Nishita1987 at 256 steps, and Chen2011's picture hardly changes"
)


@dataclass(frozen=True)
class Planted:
    """One error.

    Attributes
    ----------
    name, part : str          what is planted, and in which of `PARTS` it belongs
    technique, spoilt : str   names or cells, such as "lit_intervals+sun2005"
    settings, changes : dict  of both techniques, and of the spoilt one
    scene, parameters         that they draw
    """

    name: str
    part: str
    technique: str
    spoilt: str
    settings: dict[str, int] = field(default_factory=dict)
    changes: dict[str, int] = field(default_factory=dict)
    scene: str = "sphere"
    parameters: dict[str, object] = field(default_factory=dict)


PLANTED = (
    Planted("a table of half the size", MODEL, "lit_intervals+sun2005", "lit_intervals+sun2005:32"),
    # with other techniques less of it is charged to its part, or hardly anything happens: see SHADOW_MAPS
    Planted("a shadow map of 128 x 128", SHADOW_MAP, "Weng2010", "Weng2010", {}, {"shadow_map": 128}),
    Planted("downsampling by 8", LATTICE, "Weng2010", "Weng2010", {}, {"downsample": 8}),
    Planted(
        "a flipped g",
        MODEL,
        "lit_intervals+quadrature",
        f"lit_intervals+{FLIPPED}",
        parameters={"phase": "hg", "g": 0.6},
    ),
)


@dataclass(frozen=True)
class Outcome:
    """What the attribution said of a planted error.

    Attributes
    ----------
    planted : Planted
    before, after : Attribution    of the technique, and of the spoilt one
    """

    planted: Planted
    before: Attribution
    after: Attribution

    @property
    def changes(self) -> dict[str, float]:
        """By how much the squared error of each part grew; one that a technique has not has none."""

        def value(found: Attribution, part: str) -> float:
            return found.split.parts[part].value if part in found.split.parts else 0.0

        return {part: value(self.after, part) - value(self.before, part) for part in PARTS}

    @property
    def change(self) -> float:
        """By how much the whole squared error grew, over what it was."""
        before = self.before.split.whole.value
        return (self.after.split.whole.value - before) / before

    @property
    def is_noticed(self) -> bool:
        """Whether the picture changed so much that there is something to charge to a part."""
        return abs(self.change) > LEAST_CHANGE

    @property
    def own_share(self) -> float:
        """How much of all changes is in the part in which the error was planted; NaN where it is not noticed."""
        if not self.is_noticed:
            return float("nan")
        return self.changes[self.planted.part] / sum(map(abs, self.changes.values()))


def try_planted(planted: Planted) -> Outcome:
    """Split the error of the technique and of the spoilt one.

    Raises
    ------
    InputError
        As `attribute`; or the reference cannot be made.
    """
    scene = load(planted.scene, SIZE, **planted.parameters)
    reference = deterministic_reference(scene)
    with flipped_model(), Pictures(scene) as pictures:
        before, after = (
            attribute(pictures, find_technique(name, **settings), reference)
            for name, settings in (
                (planted.technique, planted.settings),
                (planted.spoilt, planted.settings | planted.changes),
            )
        )
    return Outcome(planted, before, after)


@contextmanager
def flipped_model() -> Iterator[None]:
    """Register `quadrature` with the lobe of Henyey and Greenstein pointing backward, for a while.

    It has no twin in float64, for the error is to be the model's alone.
    """
    right = AIRLIGHT_MODELS["quadrature"]
    file = "phase/hg.glsl"
    text = (shader_source.SHADERS / file).read_text(encoding="utf-8")
    # the shader asks the other half-angle
    flipped = text.replace("half_angle.y : half_angle.x", "half_angle.x : half_angle.y")
    AIRLIGHT_MODELS[FLIPPED] = replace(right, generated=lambda phase: {**right.generated(phase), file: flipped})
    try:
        yield
    finally:
        del AIRLIGHT_MODELS[FLIPPED]


def planted_table(outcomes: Sequence[Outcome]) -> Table:
    """A line an error: what each part's share changed by, and the whole."""
    table = plain_table(Text("Change of each part, over the sum of all changes counted positive [%]"))
    table.add_column("planted", overflow="fold")
    table.add_column("belongs to")
    for heading in (*PARTS, "whole"):
        table.add_column(heading, justify="right")
    for outcome in outcomes:
        total = sum(map(abs, outcome.changes.values()))
        cells = [f"{100 * change / total:.2f}" if outcome.is_noticed else "-" for change in outcome.changes.values()]
        table.add_row(outcome.planted.name, outcome.planted.part, *cells, f"{outcome.change:+.2g}")
    table.caption = "whole: by how much the squared error grew, over what it was. -: the picture hardly changed."
    return table
