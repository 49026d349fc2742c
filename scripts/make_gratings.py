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
HALF_WIDTH, HALF_DEPTH = 1.0, 2.0


def grating(gaps: int) -> str:
    """Wavefront OBJ of the bars, in the plane y = 0: from the left BARS / gaps of them, a gap as wide, and so on."""
    width, together = HALF_WIDTH / BARS, BARS // gaps
    vertices, faces = [], []
    for bar in range(BARS):
        left = -HALF_WIDTH + width * (bar + together * (bar // together))
        corners = ((left, -HALF_DEPTH), (left, HALF_DEPTH), (left + width, HALF_DEPTH), (left + width, -HALF_DEPTH))
        vertices += [f"v {x:g} 0 {z:g}" for x, z in corners]
        first = 4 * bar + 1
        faces += [f"f {first} {first + 1} {first + 2}", f"f {first} {first + 2} {first + 3}"]
    return "\n".join([f"# {BARS} bars with {gaps} gaps, by scripts/make_gratings.py", *vertices, *faces, ""])


def main() -> None:
    """Write all files."""
    for gaps in GAPS:
        (FOLDER / f"grating_{gaps}.obj").write_text(grating(gaps), encoding="utf-8")


if __name__ == "__main__":
    main()
