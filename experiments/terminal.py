"""What a person sees in the terminal: progress, tables, notices."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from rich.progress import BarColumn, SpinnerColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from experiments.bars import Bars
from experiments.console import plain_table, warn
from experiments.metrics import Metrics
from experiments.runner import Row, Watcher, technique_label
from gpu_impl.techniques import SETTINGS
from reference.convergence import Progress as Convergence
from reference.estimate import Reference
from scenes.llvm import LlvmChoice, choose_llvm
from scenes.mitsuba_setup import mitsuba
from scenes.model import Scene


class TerminalWatcher(Bars, Watcher):
    """Progress bars for a run or for one reference; a context manager."""

    def __init__(self, rel_error: float) -> None:
        self._rel_error = rel_error
        super().__init__(
            SpinnerColumn(),
            TextColumn("{task.description:<34}"),
            BarColumn(),
            TaskProgressColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.fields[note]}"),
        )
        self._cases: Any = None
        self._estimate: Any = None

    def _bar(self, description: str, total: float) -> Any:
        # the first bar opens the display: a command that is refused before it leaves no empty line
        self._progress.start()
        return self._progress.add_task(description, total=total, note="")

    def case(self, name: str, number: int, total: int) -> None:
        """Move the bar of cases."""
        if self._cases is None:
            self._cases = self._bar("", total)
        left = ""
        if 0 < number < total:
            seconds = self._progress.tasks[self._cases].elapsed or 0.0
            left = f"about {seconds / number * (total - number):.0f} s left"
        self._progress.update(self._cases, description=name, completed=number, note=left)

    def scene(self, scene: Scene) -> None:
        """Say what is not as the file has it."""
        announce_scene(scene)

    def reference(self, progress: Convergence) -> None:
        """Move the bar of the reference: passes done of those that the present error asks for."""
        if self._estimate is None:
            self._estimate = self._bar("  reference", 1.0)
        share = progress.seconds / max(progress.seconds + progress.seconds_left, 1e-9)
        note = f"error {progress.rel_error:.2%} of {self._rel_error:.2%}, about {progress.seconds_left:.0f} s left"
        self._progress.update(self._estimate, completed=share, note=note)

    def estimated(self, reference: Reference) -> None:
        """Say what is not as it was asked for."""
        announce_reference(reference)


def announce_scene(scene: Scene) -> None:
    """Say which meshes are not the real ones, and what of the file is replaced."""
    if scene.replaced:
        warn(f"{scene.name}: single scattering is computed, not what its integrator '{scene.replaced[0]}' would be.")
    if scene.stand_ins:
        warn(
            f"{scene.name}: a procedural stand-in serves for {', '.join(scene.stand_ins)}; "
            "set AIRLIGHT_MESH_DIR to a folder with the mesh to use the real one (`airlight meshes list`)."
        )


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
    """Errors of each case: the scattering layer, and HDR-FLIP of the composite beside it."""
    table = plain_table("Scattering: errors against the reference")
    # in a narrow terminal the names fold; the numbers never do
    table.add_column("scene", overflow="fold")
    table.add_column("technique", overflow="fold")
    for heading in ("median", "95 %", "99 %", "mean +-", "relMSE", "RMSE", "bias", "FLIP", "FLIP all", "noise"):
        table.add_column(heading, justify="right", no_wrap=True)
    composite = {_case(row): row["flip"] for row in rows if row["layer"] == "composite"}
    for row in rows:
        if row["layer"] != "scattering":
            continue
        table.add_row(
            row["scene"] + ("*" if row["stand_ins"] else ""),
            technique_label(row["technique"], row),
            f"{row['rel_50']:.3%}",
            f"{row['rel_95']:.3%}",
            f"{row['rel_99']:.3%}",
            f"{row['mean_rel']:+.3%}",
            f"{row['rel_mse']:.1e}",
            f"{row['rmse']:.1e}",
            f"{row['bias']:.1e}",
            f"{row['flip']:.4f}",
            f"{composite[_case(row)]:.4f}",
            f"{float(row['rel_error']):.2%}",
        )
    first = rows[0]
    starred = " * with stand-in meshes." if any(row["stand_ins"] for row in rows) else ""
    table.caption = (
        "median, 95 %, 99 % of |t - r| / max(r, 1 % of the lit median) where either is lit; mean +- of the same with "
        "its sign. bias: RMSE without the reference's noise. FLIP all: of the composite. noise: relative standard "
        "error of the reference, 95 %."
        f"{starred}\n{first['gl_renderer']}; reference {first['estimator']}, {first['variant']}."
    )
    return table


def _case(row: Row) -> tuple[str, ...]:
    return tuple(str(row[key]) for key in ("scene", "technique", *SETTINGS))


def metrics_table(layer: str, metrics: Metrics) -> Table:
    """All metrics of one layer, a line each."""
    table = Table(title=f"{layer} against the reference", title_justify="left")
    table.add_column("metric")
    table.add_column("value", justify="right")
    for name, value in asdict(metrics).items():
        table.add_row(name, "-" if value is None else f"{value:.6g}")
    return table
