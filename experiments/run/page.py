"""A run as a page of results: what its study says, its plots, its table, and what made it."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any

import polars

from experiments.pages import prepare_page
from experiments.run.folder import read_record, read_table
from experiments.studies import Plot, find_study
from scenes.replacing import replacing

PAGE = """# {title}

{made}

{text}

{plots}
[results.csv](results.csv) has every column of {count}.
"""


def write_page(folder: Path, out: Path) -> Path:
    """Write README.md, results.csv and the plots of a run.

    Raises
    ------
    InputError
        The folder is no run's, or `out` cannot be written or holds another page.
    """
    record, table = read_record(folder), read_table(folder)
    study = find_study(record["study"])
    prepare_page(out, study.title)
    made = made_by_run(record, table, folder, out)
    plots = [_write_plot(out, plot, made) for plot in study.plots(table)]
    with replacing(out / "results.csv") as beside:
        # seven digits: pictures are float32
        table.write_csv(beside, float_scientific=True, float_precision=6)
    total = record.get("cases", len(table))
    count = f"all {total} cases" if len(table) == total else f"{len(table)} of {total} cases: the run was stopped"
    text = PAGE.format(title=study.title, made=made, text=study.text(table), plots="\n".join(plots), count=count)
    with replacing(out / "README.md") as beside:
        beside.write_text(text, encoding="utf-8")
    return out / "README.md"


def made_by_run(record: dict[str, Any], table: polars.DataFrame, folder: Path, out: Path) -> str:
    """Which commands made a page, when, with what and on which machine."""
    done = table.filter(table["status"] == "done")
    stand_ins = sorted({name for names in _values(done, "stand_ins") for name in names.split()})
    meshes = f"stand-ins for {', '.join(stand_ins)}" if stand_ins else "all meshes are the scenes' own"
    versions = ", ".join(f"{name} {record[name]}" for name in ("airlight", "python", "mitsuba", "drjit", "numpy"))
    drawn = f", on {', '.join(_values(done, 'gl_renderer'))}; {meshes}" if len(done) else ""
    # a page is read on other machines
    run, to = ("..." if path.is_absolute() else str(path) for path in (folder, out))
    return (
        f"Made on {record['begun'][:10]} at commit {record['commit']} by\n\n"
        f"    {record['command']}\n    airlight page {run} --out {to}\n\n"
        + textwrap.fill(f"with {versions}{drawn}.", 120)
    )


def _values(table: polars.DataFrame, column: str) -> list[str]:
    if column not in table.columns:
        return []
    return [value for value in table[column].unique(maintain_order=True).to_list() if value]


def _write_plot(out: Path, plot: Plot, made: str) -> str:
    """Write one plot, and return its lines of the page."""
    with replacing(out / f"{plot.name}.png") as beside:
        plot.figure.savefig(beside, format="png", metadata={"Description": " ".join(made.split())})
    return f"![{plot.caption}]({plot.name}.png)\n\n{plot.caption}\n"
