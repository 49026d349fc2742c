"""Writes the bars of experiments/suites/scenes/grating.xml, a file for each number of gaps.

All files have the same bars, cover the same half of the same opening, and differ in how the bars stand together: a ray
behind them is lit on as many pieces as there are gaps, along the same length in all, and everything else that a frame
costs stays the same.

    python scripts/make_gratings.py
"""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).parent.parent / "experiments" / "suites" / "scenes"
BARS = 32
GAPS = (1, 2, 4, 8, 16, 32)
# the opening in x and in z; the scene has the light above its middle
HALF_WIDTH, HALF_DEPTH, HEIGHT = 1.0, 2.0, 2.0
BSDF = '  <bsdf type="twosided" id="bars"><bsdf type="diffuse"><rgb name="reflectance" value="0.4"/></bsdf></bsdf>'


def grating(gaps: int) -> str:
    """Mitsuba XML of the bars, in the plane y = HEIGHT: from the left BARS / gaps of them, a gap as wide, and so on."""
    width, together = HALF_WIDTH / BARS, BARS // gaps
    lines = [f"<!-- {BARS} bars with {gaps} gaps, by scripts/make_gratings.py. -->", '<scene version="3.0.0">', BSDF]
    for bar in range(BARS):
        middle = -HALF_WIDTH + width * (bar + together * (bar // together) + 0.5)
        place = (
            f'<scale x="{0.5 * width:g}" y="{HALF_DEPTH:g}"/><rotate x="1" angle="-90"/>'
            f'<translate x="{middle:.10g}" y="{HEIGHT:g}"/>'
        )
        lines.append(
            f'  <shape type="rectangle" id="bar_{bar}"><transform name="to_world">{place}</transform>'
            '<ref id="bars"/></shape>'
        )
    return "\n".join([*lines, "</scene>", ""])


def main() -> None:
    """Write all files."""
    for gaps in GAPS:
        (FOLDER / f"grating_{gaps}.xml").write_text(grating(gaps), encoding="utf-8")


if __name__ == "__main__":
    main()
