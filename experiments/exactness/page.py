"""What `airlight exactness --out` writes: a page."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

from experiments.exactness.study import GOAL, Case
from experiments.exactness.table import HEADINGS, MEANING, cells, verdict
from experiments.markdown import table
from experiments.pages import made_by
from scenes.replacing import replacing

TITLE = "Whether the controls are exact"
PAGE = """# {title}

{made} Drawn on {renderer}.

Visibility `exact` reads every texel of the shadow map that a ray crosses, so that what is left is the map's; `given`
takes the reference's own lit intervals, so that nothing of visibility is. Both with the model `quadrature`, at {size},
every pixel evaluated: {verdict}.

{table}

{meaning}. `exact` is held against the deterministic reference; `given`, which has that one's intervals, against an
estimate with a relative standard error of {rel_error:.1%} that shares no ray with it: by pixels, 8 x 8 tiles and the
image's mean, of which each may fail once in 10,000 times by chance.

Doubling a map leaves half of the borders between its texels where they are: a shadow's edge within a quarter of a texel
of one is told in the same wrong place twice, and its pixels count as stable. With moved borders they do not.
"""


def write_page(
    folder: Path, cases: Sequence[Case], scenes: Sequence[str], size: tuple[int, int], shadow_map: int | None
) -> None:
    """Write README.md over the one that is there.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    asked = [] if shadow_map is None else ["--shadow-map", str(shadow_map)]
    command = shlex.join(["airlight", "exactness", *scenes, "--size", *map(str, size), *asked, "--out", str(folder)])
    text = PAGE.format(
        title=TITLE,
        made=made_by(command, "mitsuba", "moderngl", "numpy"),
        renderer=cases[0].told["gl_renderer"],
        size=" x ".join(map(str, size)),
        verdict=verdict(cases),
        table=table(HEADINGS, [cells(case) for case in cases]),
        meaning=MEANING,
        rel_error=GOAL.rel_error,
    )
    with replacing(folder / "README.md") as beside:
        beside.write_text(text, encoding="utf-8")
