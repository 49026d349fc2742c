"""The table of `airlight exactness`, in the terminal and on its page."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from experiments.console import plain_table
from experiments.exactness.study import LESS, MEAN_LIMIT, PIXEL_LIMIT, PIXELS, SHARE, STABLE, Case

HEADINGS = ("scene", "map", "image mean", "stable", "right", "moved", "right", "given", "reads", "ms")
MEANING = (
    "map: texels on a side of a tile, twice as many as before; image mean: error of exact x quadrature, at most "
    f"{MEAN_LIMIT:.1%}; stable: pixels with airlight whose lit length that doubling changes by less than "
    f"{STABLE:.1%}, at least {SHARE:.0%}; right: how many of those are within {PIXEL_LIMIT:.1%} of the reference, at "
    f"least {PIXELS:.0%}; moved: the same where the map before has 1/{1 / LESS:.0f} of its texels less, so that no "
    "border between texels stays where it is; given: the "
    "largest score of a pixel of given x quadrature against the sampled reference, over the critical one; reads: of "
    "the map and its pyramid, a ray; ms: a frame"
)


def cells(case: Case) -> tuple[str, ...]:
    """Texts of one case's row."""
    pixels = case.given.verdicts[0]
    return (
        case.scene,
        str(case.shadow_map),
        f"{case.image_mean:+.4%}",
        *(text for one in (case.doubled, case.moved) for text in (f"{one.share:.1%}", f"{one.within:.2%}")),
        f"{abs(pixels.largest):.2f} / {pixels.critical:.2f}",
        f"{case.reads:.0f}",
        f"{case.milliseconds:.0f}",
    )


def exactness_table(cases: Sequence[Case]) -> Table:
    """A line a scene."""
    table = plain_table("exact x quadrature and given x quadrature against the reference")
    for number, heading in enumerate(HEADINGS):
        table.add_column(heading, justify="right" if number else "left", no_wrap=True)
    for case in cases:
        table.add_row(*cells(case))
    table.caption = MEANING
    return table


def verdict(cases: Sequence[Case]) -> str:
    """What holds for how many scenes, and which do not keep it."""
    held = {
        "an image mean within the limit": [case.unbiased for case in cases],
        "stable pixels that are enough and right": [case.doubled.passes for case in cases],
        "the same with moved borders": [case.moved.passes for case in cases],
        "given intervals within the reference's noise": [case.given.agrees for case in cases],
    }
    return "; ".join(_held(cases, what, found) for what, found in held.items())


def _held(cases: Sequence[Case], what: str, held: Sequence[bool]) -> str:
    missed = [case.scene for case, one in zip(cases, held, strict=True) if not one]
    return f"{what}: {sum(held)} of {len(held)}{', not ' + ', '.join(missed) if missed else ''}"
