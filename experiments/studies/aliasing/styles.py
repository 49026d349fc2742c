"""One colour and one mark for each technique in all of the study's figures."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.lines import Line2D

# Okabe and Ito's colours, which colour-blind people can tell apart; marks too, as curves may lie on each other
COLOURS = ("#d55e00", "#e69f00", "#56b4e9", "#0072b2", "#009e73", "#cc79a7", "#000000")
MARKS = ("o", "s", "^", "D", "v", "P", "X")


class Styles:
    """Gives each name the next colour and mark, and the first ones again behind the last."""

    def __init__(self, names: list[str]) -> None:
        self._place = {name: number for number, name in enumerate(names)}

    def colour(self, name: str) -> str:
        """The colour of a technique."""
        return COLOURS[self._place[name] % len(COLOURS)]

    def mark(self, name: str) -> str:
        """The mark of a technique, as matplotlib calls it."""
        return MARKS[self._place[name] % len(MARKS)]

    def handles(self) -> list[Line2D]:
        """The legend's entries."""
        from matplotlib.lines import Line2D

        return [
            Line2D([], [], color=self.colour(name), marker=self.mark(name), mfc="none", label=name)
            for name in self._place
        ]
