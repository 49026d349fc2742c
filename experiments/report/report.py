"""Writes the report of a run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from experiments.heat_maps.heat_map import NOISE
from experiments.report.pictures import LAYER, choose_pictures
from experiments.report.study import study_plots, study_text
from experiments.report.table import cell_text, result_table
from experiments.run.folder import read_record, read_table
from experiments.run.rows import Row
from experiments.studies import find_study
from experiments.technique_label import technique_label
from scenes.replacing import replacing

REPORT = "report.html"
WEB = Path(__file__).parent / "web"
STYLE, SCRIPTS = "report.css", ("table.js", "decode.js", "colours.js", "viewer.js", "controls.js")
# of the cases, if any has it: what drew and what estimated
MAKERS = ("gl_renderer", "gl_version", "estimator", "variant")
# of run.json, with the words for them
RECORDED = {
    "suite": "suite",
    "command": "command",
    "begun": "begun",
    "finished": "finished",
    "commit": "commit",
    "machine": "machine",
    "airlight": "airlight",
    "mitsuba": "Mitsuba",
    "drjit": "Dr.Jit",
    "numpy": "numpy",
    "python": "Python",
}


def write_report(folder: Path) -> Path:
    """Write report.html into the folder of a run, from its run.json, its results.parquet and its EXR files.

    The page holds all that it shows, and works from the file system. Pictures are half floats in it, each value within
    a relative 2^-11 of the EXR's; see `experiments.report.halves`.

    Returns
    -------
    Path
        Of the page.

    Raises
    ------
    InputError
        The folder is no run's, has no table yet, or cannot be written.
    """
    record = read_record(folder)
    table = read_table(folder)
    rows = table.to_dicts()
    study = find_study(record["study"])
    done = [row for row in rows if row["status"] == "done"]
    shown = choose_pictures(folder, done)
    page = _environment().get_template("report.html.j2").render(
        record={said: record[key] for key, said in RECORDED.items() if record.get(key)},
        makers={key: made for key in MAKERS if (made := _values(rows, key))},
        part=_part(record, len(rows)),
        counts=Counter(row["status"] for row in rows),
        failed=[row for row in rows if row["status"] == "failed"],
        refused=_by_reason(rows),
        study=study,
        # without a measured case a study has nothing to tell
        text=study_text(study, table) if done else "",
        plots=list(study_plots(study, table)) if done else [],
        table=result_table(rows),
        shown=shown,
        abouts=[_about(folder, case, rows) for case in shown.cases],
        places={case["name"]: place for place, case in enumerate(shown.cases)},
        layer=LAYER,
        noise=NOISE,
        style=Markup((WEB / STYLE).read_text(encoding="utf-8")),
        scripts=[Markup((WEB / name).read_text(encoding="utf-8")) for name in SCRIPTS],
    )  # fmt: skip
    path = folder / REPORT
    with replacing(path) as beside:
        beside.write_text(page, encoding="utf-8", errors="replace")
    return path


def _part(record: dict[str, Any], count: int) -> str:
    """What a page of some of a run's cases has to say first; empty where it has all, failed ones among them.

    A run is finished only after its report is written, so that `finished` is missing in the report of a whole one.
    """
    total = record.get("cases")
    if total is None:
        # begun by a version that did not count
        return "" if record.get("finished") else f"{count} cases; the run was stopped or is going on."
    return f"{count} of {total} cases; the run was stopped or is going on." if count < total else ""


def _environment() -> Environment:
    """Everything that a template shows is escaped, but for what is marked as HTML; an unknown name is an error."""
    loader = PackageLoader("experiments.report", "web")
    found = Environment(loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    found.filters["cell"] = cell_text
    return found


def _values(rows: Sequence[Row], key: str) -> str:
    """What the rows have under a key, each once."""
    return "; ".join(dict.fromkeys(str(row[key]) for row in rows if row.get(key)))


def _by_reason(rows: Sequence[Row]) -> dict[str, list[str]]:
    """Names of the refused cases, by their techniques' sentences."""
    found: dict[str, list[str]] = {}
    for row in rows:
        if row["status"] == "refused":
            found.setdefault(row["reason"], []).append(row["case"])
    return found


def _about(folder: Path, case: dict[str, Any], rows: Sequence[Row]) -> dict[str, Any]:
    """What stands below a case's picture: what it is, its files, and how much of it is shown."""
    row = next(row for row in rows if row["case"] == case["name"])
    names = [case["exr"], f"{case['name']}.png"]
    return {
        "label": f"{row['scene']}, {row['phase']}, {technique_label(row['technique'], row)}",
        "stand_ins": row.get("stand_ins"),
        "step": case["step"],
        "size": f"{row['width']} x {row['height']}",
        # "./" first: no name is taken for an address
        "files": {name: f"./{quote(name)}" for name in names if (folder / name).is_file()},
    }
