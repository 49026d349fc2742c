"""What a person sees in the terminal: progress, tables, notices."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rich.progress import BarColumn, SpinnerColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from experiments.bars import Bars
from experiments.console import plain_table, warn
from experiments.run.rows import Row
from experiments.run.watcher import Watcher
from experiments.scene_notices import scene_notices
from experiments.technique_label import technique_label
from reference.convergence import Progress as Convergence
from reference.estimate import Reference
from scenes.llvm import LlvmChoice, choose_llvm
from scenes.mitsuba_setup import mitsuba
from scenes.model import Scene

# a grid of hundreds of cases is read in its report
MOST_LINES = 60
COLUMNS = (
    SpinnerColumn(),
    TextColumn("{task.description:<34}"),
    BarColumn(),
    TaskProgressColumn(),
    TimeElapsedColumn(),
    TextColumn("{task.fields[note]}"),
)


class ReferenceWatcher(Bars):
    """A progress bar for one reference; a context manager."""

    def __init__(self, rel_error: float) -> None:
        self._rel_error = rel_error
        super().__init__(*COLUMNS)
        self._estimate: Any = None

    def reference(self, progress: Convergence) -> None:
        """Move the bar: passes done of those that the present error asks for."""
        if self._estimate is None:
            # the first bar opens the display: a command that is refused before it leaves no empty line
            self._progress.start()
            self._estimate = self._progress.add_task("  reference", total=1.0, note="")
        share = progress.seconds / max(progress.seconds + progress.seconds_left, 1e-9)
        note = f"error {progress.rel_error:.2%} of {self._rel_error:.2%}, about {progress.seconds_left:.0f} s left"
        self._progress.update(self._estimate, completed=share, note=note)


class RunWatcher(Bars, Watcher):
    """A progress bar for the cases of a run; a context manager."""

    def __init__(self, folder: Path) -> None:
        super().__init__(*COLUMNS)
        self._folder = folder
        self._cases: Any = None
        self._before, self._failed = 0, 0

    def begin(self, done: int, total: int) -> None:
        """Open the bar."""
        if done:
            warn(f"Going on with {self._folder}: {done} of {total} cases are there.")
        self._before = done
        self._progress.start()
        self._cases = self._progress.add_task("", total=total, completed=done, note="")

    def step(self, event: dict[str, Any]) -> None:
        """Say which case a worker is at."""
        said = event["case"]
        if event.get("step") == "reference":
            said += f": reference at {event['error']:.2%}, about {event['seconds_left']:.0f} s left"
        self._progress.update(self._cases, description=said)

    def case(self, row: Row) -> None:
        """Move the bar."""
        self._failed += row["status"] == "failed"
        task = self._progress.tasks[0]
        done = int(task.completed) + 1
        seconds = (task.elapsed or 0.0) / max(done - self._before, 1) * ((task.total or 0) - done)
        notes = [f"{self._failed} failed" if self._failed else "", f"about {seconds:.0f} s left" if seconds else ""]
        self._progress.update(self._cases, completed=done, note=", ".join(filter(None, notes)))


def announce_scene(scene: Scene) -> None:
    """Say which meshes are not the real ones, and what of the file is replaced."""
    for notice in scene_notices(scene):
        warn(notice)


def announce_variant() -> None:
    """Say so where the reference has to do without LLVM, or without the LLVM that was asked for."""
    choice, variant = choose_llvm(), mitsuba().variant()
    if choice.asked_for and choice.rejected and choice.rejected[0].path == choice.asked_for:
        warn(
            f"DRJIT_LIBLLVM_PATH names {choice.asked_for}, which {choice.rejected[0].reason}; "
            f"{'using ' + choice.usable.path if choice.usable else 'no other was found'}."
        )
    if variant == "scalar_rgb":
        warn(
            "The reference comes from Mitsuba's C++ volpath in scalar_rgb, slower and averaged over pixels "
            f"instead of at their centres: {_why_scalar(choice)}."
        )


def _why_scalar(choice: LlvmChoice) -> str:
    if choice.usable:
        return "AIRLIGHT_MITSUBA_VARIANT asks for it"
    return "there is no LLVM that Dr.Jit can use (`make setup` installs one, `airlight doctor` says more)"


def announce_reference(reference: Reference) -> None:
    """Say so where a limit stopped a reference, or what became of its entry in the cache."""
    for notice in reference.notices:
        warn(notice)
    estimate = reference.estimate
    if not estimate.reached:
        limit = "time limit" if estimate.stopped_by == "time" else "sample limit"
        warn(
            f"The reference stopped at its {limit} with a relative standard error of {estimate.rel_error:.2%} where "
            f"{reference.goal.rel_error:.2%} was asked for; asked for again, it goes on from there."
        )


def told(reference: Reference) -> str:
    """What a reference is and where it came from, as the end of a sentence."""
    estimate, before = reference.estimate, reference.passes_before
    if reference.from_cache:
        source = "from the cache"
    elif before:
        source = f"{before} of them from the cache, {estimate.seconds:.1f} s in all"
    else:
        source = f"{estimate.seconds:.1f} s"
    at = f"at the {reference.goal.percentile:g}th percentile"
    if not estimate.passes:
        return f"deterministic, relative numerical error {estimate.rel_error:.1e} {at}, {source}"
    return (
        f"relative standard error {estimate.rel_error:.3%} {at}, {estimate.passes} passes of "
        f"{float(estimate.samples.mean()):.3g} samples a pixel, {source}"
    )


def results_table(rows: list[Row]) -> Table:
    """Errors of each case: the scattering layer, and HDR-FLIP of the composite beside it; or what else was measured."""
    drawn = [row for row in rows if row["status"] != "failed"]
    if not any(row.get("scattering.rel_50") is not None for row in drawn):
        return _plain_results(drawn)
    table = plain_table("Scattering: errors against the reference")
    # in a narrow terminal the names fold; the numbers never do
    table.add_column("scene", overflow="fold")
    table.add_column("technique", overflow="fold")
    for heading in ("median", "95 %", "99 %", "mean +-", "relMSE", "RMSE", "bias", "FLIP", "FLIP all", "noise"):
        table.add_column(heading, justify="right", no_wrap=True)
    for row in drawn[:MOST_LINES]:
        label = technique_label(row["technique"], row)
        star = "*" if row["stand_ins"] else ""
        where = " ".join(
            filter(None, (row["scene"] + star, row["phase"] if _vary(drawn, "phase") else "", row["camera"]))
        )
        if row["status"] == "refused" or row.get("scattering.rel_50") is None:
            table.add_row(where, label, row["reason"][:20] + "..." if row["reason"] else "-")
            continue
        table.add_row(
            where,
            label,
            f"{row['scattering.rel_50']:.3%}",
            f"{row['scattering.rel_95']:.3%}",
            f"{row['scattering.rel_99']:.3%}",
            f"{row['scattering.mean_rel']:+.3%}",
            f"{row['scattering.rel_mse']:.1e}",
            f"{row['scattering.rmse']:.1e}",
            f"{row['scattering.bias']:.1e}",
            f"{row['scattering.flip']:.4f}",
            "-" if row["composite.flip"] is None else f"{row['composite.flip']:.4f}",
            f"{float(row['rel_error']):.2%}",
        )
    first = next(row for row in drawn if row["status"] == "done")
    starred = " * with stand-in meshes." if any(row["stand_ins"] for row in drawn) else ""
    more = f" {len(drawn) - MOST_LINES} more cases are in results.csv." if len(drawn) > MOST_LINES else ""
    table.caption = (
        "median, 95 %, 99 % of |t - r| / max(r, 1 % of the lit median) where either is lit; mean +- of the same with "
        "its sign. bias: RMSE without the reference's noise. FLIP all: of the composite. noise: relative standard "
        "error of the reference, 95 %."
        f"{starred}{more}\n{first['gl_renderer']}; reference {first['estimator']}, {first['variant']}."
    )
    return table


def _plain_results(rows: list[Row]) -> Table:
    """A line a case with the first columns of what was measured."""
    table = plain_table("Results")
    keys = [key for key in rows[0] if "." in key][:8] if rows else []
    for row in rows:
        keys = keys or [key for key in row if "." in key][:8]
    table.add_column("case", overflow="fold")
    for key in keys:
        table.add_column(key, justify="right", overflow="fold")
    for row in rows[:MOST_LINES]:
        values = (row.get(key) for key in keys)
        table.add_row(
            row["case"], *(f"{value:.4g}" if isinstance(value, int | float) else str(value) for value in values)
        )
    return table


def _short(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, int | float) else str(value)


def _vary(rows: list[Row], key: str) -> bool:
    return len({row[key] for row in rows}) > 1
