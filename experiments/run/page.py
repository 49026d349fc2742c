"""A run as a page of results: what its study says, its plots, its table, and what made it."""

from __future__ import annotations

import textwrap
from pathlib import Path

import polars

from experiments.pages import prepare_page
from experiments.run.folder import read_record
from experiments.studies import Plot, find_study
from scenes.errors import InputError
from scenes.replacing import replacing

PAGE = """# {title}

{made}

{text}
{plots}
[results.csv](results.csv) has every column of all {count} cases.
"""


def read_table(folder: Path) -> polars.DataFrame:
    """The rows of a run.

    Raises
    ------
    InputError
        The folder is no run's, another version made it, or it has no table yet.
    """
    read_record(folder)
    path = folder / "results.parquet"
    try:
        return polars.read_parquet(path)
    except (OSError, polars.exceptions.PolarsError):
        raise InputError(f"{path} is missing or damaged: the same `airlight run` again writes it.") from None


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
    made = made_by_run(record, table, out)
    plots = [_write_plot(out, plot, made) for plot in study.plots(table)]
    with replacing(out / "results.csv") as beside:
        table.write_csv(beside)
    text = PAGE.format(title=study.title, made=made, text=study.text(table), plots="\n".join(plots), count=len(table))
    with replacing(out / "README.md") as beside:
        beside.write_text(text, encoding="utf-8")
    return out / "README.md"


def made_by_run(record: dict, table: polars.DataFrame, out: Path | None = None) -> str:
    """Which commands made a page, when, from what and on which machine."""
    done = table.filter(table["status"] == "done")
    renderers = ", ".join(_values(done, "gl_renderer"))
    stand_ins = sorted({name for names in _values(done, "stand_ins") for name in names.split()})
    versions = ", ".join(f"{name} {record[name]}" for name in ("airlight", "python", "mitsuba", "drjit", "numpy"))
    page = f"\n    airlight page {record.get('folder', 'runs/' + record['suite'] + '-...')} --out {out}" if out else ""
    lines = [
        f"Made on {record['begun'][:10]} at commit {record['commit']} by\n\n    {record['command']}{page}\n",
        textwrap.fill(
            f"with {versions}, on {renderers or 'no renderer'}; "
            + (f"stand-ins for {', '.join(stand_ins)}" if stand_ins else "all meshes are the scenes' own")
            + ".",
            120,
        ),
    ]
    return "\n".join(lines)


def _values(table: polars.DataFrame, column: str) -> list[str]:
    if column not in table.columns:
        return []
    return [value for value in table[column].unique(maintain_order=True).to_list() if value]


def _write_plot(out: Path, plot: Plot, made: str) -> str:
    """Write one plot, and return its lines of the page."""
    with replacing(out / f"{plot.name}.png") as beside:
        plot.figure.savefig(beside, format="png", metadata={"Description": " ".join(made.split())})
    return f"![{plot.caption}]({plot.name}.png)\n\n{plot.caption}\n"
