"""The page's part that says what was measured and how, from the constants that decide it."""

from __future__ import annotations

from experiments.atlas.errors import TRUTH
from experiments.atlas.grid import BESIDE, INSIDE, RANGE, SIGMA_T, VISIBLE_DEPTH, Grid
from experiments.atlas.timing import REFERENCE, ROUNDS
from experiments.atlas.truth import CHECKED

__all__ = ["method"]


def method(grid: Grid, truths: dict[str, float], timed: int) -> str:
    """A list in Markdown.

    Parameters
    ----------
    truths : largest relative error of the truth by phase function
    timed : int  segments that were timed
    """
    cells, _, positions = grid.shape
    beside = ", ".join(f"{x:.2g}" for x in BESIDE)
    inside = ", ".join(f"{share:g}" for share in INSIDE)
    checked = "; ".join(f"{label} {error:.1e}" for label, error in truths.items())
    return f"""\
- **Cells.** H = sigma_t h and T = sigma_t (x_b - x_a), {RANGE[0]:g} to {RANGE[1]:g} each, in {cells} values equally \
spaced in the logarithm. In every cell the same {positions} positions: the eye, where the segment begins, stands \
{beside} optical lengths before the light's projection on the ray (a longer segment then contains it) or as far \
behind it; or the projection lies at {inside} of the segment. That makes {len(grid.segments):,} segments. sigma_t is \
drawn for each from {SIGMA_T[0]:g} to {SIGMA_T[1]:g}, log-uniform, from a fixed seed, so that no product is exact by \
chance.
- **Visible** is a segment at whose eye the light's optical depth, sigma_t d_a, is at most {VISIBLE_DEPTH:g}: \
{grid.visible.mean():.1%} of them.
- **Error** is |model - truth| / truth. NaN and infinities count as infinitely wrong and are drawn as 1; their share \
is in the table. A percentile is the smallest error that at least so many segments do not exceed (nearest rank).
- **float32** means inputs rounded to float32 first and every operation in float32, which is checked. The truth takes \
the same rounded inputs, so the error is the model's and its arithmetic's, not the inputs'. Segments whose airlight \
is below the smallest normal float32 number are left out.
- **Truth** is the model `{TRUTH}` in float64. It has no map of its own: it would be compared with itself. Against \
the oracle (mpmath, 30 digits) on {CHECKED} random segments of the grid, its largest relative error is: {checked}.
- **Maps** show the 95th percentile over the positions of a cell: over the visible ones, and where H is above \
{VISIBLE_DEPTH:g} and none is, over all. Their colours run from 1e-16 to 1 on every sheet.
- **Operations** are counted by running the model on arrays that add up what passes through NumPy's functions; the \
result keeps every bit. They are means over all segments of the grid, as the NumPy code evaluates them: both sides of \
a `where`, but of a masked call the masked elements alone. hypot is a square root; x^y with a fraction in y an \
exponential and a logarithm; of a complex number, an exponential has a sine and a cosine besides, a logarithm an arc \
tangent and a square root. An exponential integral counts once, complex or real, of one order or of three that follow \
from one; what it does inside is not counted. A table read counts once too, and what it computes besides.
- **Time** is NumPy's on this machine, not a GPU's: {timed:,} segments drawn from the grid, {ROUNDS} rounds in which \
every model runs once, in an order drawn anew. The ratio is to `{REFERENCE}` in the same round and precision."""
