"""`airlight attribute`: technique after technique; a table on the terminal, and the page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.table import Table
from rich.text import Text

from experiments.attribution.coalitions import PARTS
from experiments.attribution.measurement import Attribution, attribute
from experiments.attribution.page import write_page
from experiments.attribution.pictures import Pictures
from experiments.attribution.shapley import Coalition
from experiments.attribution.split import Share
from experiments.attribution.tables import REMAINS, other_surfaces, shares, told_rms
from experiments.bars import Bars
from experiments.console import console, plain_table, say
from experiments.terminal import COLUMNS
from gpu_impl.techniques import Technique
from reference.estimate import Reference
from scenes.model import Scene


class PictureWatcher(Bars):
    """A progress bar over the pictures of all techniques; a context manager."""

    def __init__(self, techniques: int) -> None:
        super().__init__(*COLUMNS)
        self._techniques = techniques
        self._begun = self._drawn = 0
        self._bar: Any = None

    def picture(self, name: str, coalition: Coalition, pictures: int) -> None:
        """Move the bar to the next picture, of so many that the technique has."""
        if self._bar is None:
            self._progress.start()
            self._bar = self._progress.add_task("", total=self._techniques, note="")
        if not coalition:
            self._begun, self._drawn = self._begun + 1, 0
        exact = ", ".join(part for part in PARTS if part in coalition)
        done = self._begun - 1 + self._drawn / pictures
        self._progress.update(self._bar, description=name, completed=done, note=f"exact {exact}" if exact else "")
        self._drawn += 1


def run_attribution(
    scene: Scene, techniques: Sequence[Technique], reference: Reference, out: Path, command: str
) -> list[Attribution]:
    """Split the error of each technique, print a table, and write the page.

    Parameters
    ----------
    out : folder
    command : that makes the page again

    Raises
    ------
    InputError
        As `attribute`; or the files cannot be written.
    """
    found = []
    with PictureWatcher(len(techniques)) as watcher, Pictures(scene) as pictures:
        for technique in techniques:

            def tell(coalition: Coalition, of: int, name: str = technique.name) -> None:
                watcher.picture(name, coalition, of)

            found.append(attribute(pictures, technique, reference, tell))
    console.print(attribution_table(found))
    write_page(out, scene, reference, found, command)
    say(f"Attribution: {(out / 'README.md').resolve()}")
    return found


def attribution_table(found: Sequence[Attribution]) -> Table:
    """A line a technique: its error, and in per cent what each part has of its square."""
    table = plain_table(Text("Share of each part in the mean squared error of the scattering layer [%]"))
    table.add_column("technique", overflow="fold")
    for heading in ("RMS", *PARTS, REMAINS):
        table.add_column(heading, justify="right", no_wrap=True)
    for one in found:
        there = shares(one)
        cells = [_cell(one, there[part]) if part in there else "-" for part in PARTS]
        table.add_row(one.label, told_rms(one, one.split.together), *cells, told_rms(one, one.split.remains))
    reasons = dict.fromkeys(f"{part}: {reason}" for one in found for part, reason in one.parts.left_out.items())
    doubt = "bound by the reference's error" if found[0].deterministic else "standard error by the reference's noise"
    table.caption = (
        "RMS: root of what all parts have together, over the reference's mean, and of what remains with all of them "
        f"exact. +-: {doubt}. {other_surfaces(found)}" + f" -: {'; '.join(reasons)}." * bool(reasons)
    )
    return table


def _cell(found: Attribution, share: Share) -> str:
    if found.split.together.is_noise:
        return "noise"
    error = 100 * share.standard_error / abs(found.split.together.value)
    return f"{100 * found.split.fraction(share):.2f} +- {error:.2f}"
