"""The report of a run: read back as a browser would read it."""

from __future__ import annotations

import base64
import json
import re
import shutil
import subprocess
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import polars
import pytest
from report_page import Page

from experiments.exr import read_exr, write_exr
from experiments.heat_maps.colours import ENTRIES, colour_map, table
from experiments.heat_maps.heat_map import LUMINANCE
from experiments.heat_maps.scale import Scale
from experiments.report import write_report
from experiments.report.halves import Blocks
from experiments.report.pictures import choose_pictures
from experiments.report.report import SCRIPTS, WEB
from experiments.report.study import study_text
from experiments.report.table import cell_text, result_table
from experiments.run.folder import FORMAT
from experiments.studies import Study
from gpu_impl.techniques import SETTINGS, find_technique
from scenes.errors import InputError

# rounding to a half float's 11 bits
ROUNDING = 2.0**-11
HOSTILE = "<script>alert('1')</script><img src=x onerror=\"alert(2)\">&amp;"


def write_pictures(path: Path, seed: int, shape: tuple[int, int] = (6, 8)) -> None:
    """A technique within 3 % of its reference, with its noise, in colour; the upper row is black."""
    rng = np.random.default_rng(seed)
    reference = rng.lognormal(-3, 2, (*shape, 3))
    reference[0] = 0
    layers = {
        "scattering": reference * rng.uniform(0.97, 1.03, reference.shape),
        "reference.scattering": reference,
        "standard_error.scattering": 1e-3 * reference,
    }
    write_exr(path, layers, {})


def row(case: str, **changes: Any) -> dict[str, Any]:
    """A row as a run keeps it."""
    technique = find_technique("Weng2010")
    return {
        "case": case,
        "product": "grid",
        "scene": "sphere",
        "phase": "isotropic",
        "width": 8,
        "height": 6,
        "camera": "",
        "technique": technique.name,
        **{setting: getattr(technique, setting) for setting in SETTINGS},
        "status": "done",
        "reason": "",
        "command": f"airlight run quick --case {case}",
        "rel_error": "0.004",
        "gl_renderer": "a renderer",
        **{f"scattering.{name}": 0.012345678 for name in ("rel_50", "rel_95", "rel_99", "image_mean_rel", "flip")},
        **changes,
    }


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A run of five cases: three are done, two of them with pictures."""
    rows = [
        row("a", **{"scattering.rel_95": 0.5}),
        row("b", steps=256, **{"scattering.rel_95": 1e-7}),
        row("c", scene=HOSTILE),
        row("d", status="refused", reason=f"No spots. {HOSTILE}", **{"scattering.rel_50": None}),
        row("e", status="failed", reason=HOSTILE, command=f"airlight run {HOSTILE}", **{"scattering.rel_50": None}),
    ]
    polars.DataFrame(rows, infer_schema_length=None).write_parquet(tmp_path / "results.parquet")
    record = {"format": FORMAT, "suite": HOSTILE, "study": "errors", "command": "airlight run x", "commit": "0123abc"}
    (tmp_path / "run.json").write_text(json.dumps(record))
    for name, seed in (("a", 1), ("b", 2)):
        write_pictures(tmp_path / f"{name}.exr", seed)
    return tmp_path


def test_the_page_holds_every_row_and_loads_nothing(folder: Path) -> None:
    path = write_report(folder)
    assert path == folder / "report.html"
    page = Page(path)
    assert [cells[0] for cells in page.rows] == list("abcde")
    assert len({len(cells) for cells in page.rows}) == 1
    numbers = json.loads(page.scripts["numbers"])
    assert [dict(zip(numbers["columns"], values, strict=True))["scattering.rel_95"] for values in numbers["rows"]] == [
        0.5,
        1e-7,
        *[0.012345678] * 3,
    ]
    assert "3 cases done, 1 refused, 1 failed" in page.text
    assert "airlight run quick --case" not in page.text.split("All numbers")[0]
    assert "0123abc" in page.text
    for tag, attributes in page.tags:
        for name in ("src", "href", "srcset", "action", "data"):
            address = attributes.get(name)
            assert address is None or re.match(r"#|\./[ab]\.exr$|data:image/png;base64,|data:,$", address), (
                tag,
                address,
            )
        assert not [name for name in attributes if name.startswith("on")]
    whole = path.read_text(encoding="utf-8")
    assert "url(" not in whole
    assert "@import" not in whole
    # what the browser holds us to, whatever a script may try
    policies = [held["content"] for tag, held in page.tags if held.get("http-equiv") == "Content-Security-Policy"]
    assert [policy.split(";")[0] for policy in policies] == ["default-src 'none'"]
    assert not re.search(r"\b(fetch|XMLHttpRequest|importScripts)\b", "".join(page.scripts.values()))
    assert sum(tag == "img" for tag, _ in page.tags) == 1


def test_what_comes_from_outside_is_text(folder: Path) -> None:
    page = Page(write_report(folder))
    # our own scripts, the data, and the texts of two techniques, references, errors and standard errors
    assert len(page.scripts) == len(SCRIPTS) + 2 + 8
    # suite in the summary and as the title, reasons, the command, the table's cells, the study
    assert page.text.count(HOSTILE) >= 6
    # JSON holds it without a bracket that could close its script
    assert HOSTILE in json.dumps(json.loads(page.scripts["numbers"])["rows"], ensure_ascii=False).replace('\\"', '"')
    assert not re.search(r"[<>&]", page.scripts["numbers"] + page.scripts["pictures"])


def test_pictures_are_the_files_within_their_rounding(folder: Path) -> None:
    page = Page(write_report(folder))
    for name in "ab":
        layers, _ = read_exr(folder / f"{name}.exr")
        test, truth = (layers[layer].astype(np.float64) for layer in ("scattering", "reference.scattering"))
        for found, image in (("technique", test), ("reference", truth)):
            expected = image.transpose(2, 0, 1)
            # measured: 0.95 of it
            assert np.abs(page.picture(name, found) - expected).max(initial=0) <= ROUNDING * expected.max()
            assert (np.abs(page.picture(name, found) - expected) <= ROUNDING * expected).all()
        error = (test - truth) @ LUMINANCE
        assert (np.abs(page.picture(name, "error")[0] - error) <= ROUNDING * np.abs(error)).all()
        noise = layers["standard_error.scattering"] @ LUMINANCE
        assert (np.abs(page.picture(name, "standard_error")[0] - noise) <= ROUNDING * noise).all()
        case = next(case for case in json.loads(page.scripts["pictures"])["cases"] if case["name"] == name)
        # one in a thousand of the pixel, three times, in per cent
        assert case["noise"]["relative"] == pytest.approx(0.3, rel=1e-5)
        assert case["scales"]["relative log"] == {"limit": 100, "linear": pytest.approx(0.1)}


def test_halves_keep_what_they_can() -> None:
    blocks = Blocks()
    grey = np.repeat(np.linspace(0, 1, 12).reshape(3, 4)[..., None], 3, axis=2)
    assert blocks.add(grey).channels == 1
    assert blocks.add(grey) == blocks.add(grey[..., 0])
    assert len(blocks.texts) == 1
    assert blocks.size == len(next(iter(blocks.texts.values())))
    assert blocks.add(1024 * grey).block == blocks.add(grey).block
    assert blocks.add(1024 * grey).exponent == blocks.add(grey).exponent + 10
    assert blocks.add(np.zeros((2, 2))).channels == 1
    grey[0, 0, 1] = np.nan
    assert blocks.add(grey).channels == 3


def test_a_page_has_room_for_so_much(folder: Path) -> None:
    rows = [row("a"), row("b"), row("without")]
    for name in "ab":
        write_pictures(folder / f"{name}.exr", 3 if name == "a" else 4, (300, 150))
    whole = choose_pictures(folder, rows)
    assert [(case["step"], case["width"], case["height"]) for case in whole.cases] == [(1, 150, 300)] * 2
    assert not whole.left_out
    # two cases of 256 x 256 pixels would not fit, of 128 x 128 pixels they do
    few = choose_pictures(folder, rows, 300_000)
    assert [(case["step"], case["width"], case["height"]) for case in few.cases] == [(3, 50, 100)] * 2
    layers, _ = read_exr(folder / "a.exr")
    every_third = layers["scattering"][::3, ::3].transpose(2, 0, 1).astype(np.float64)
    halves = few.cases[0]["technique"]
    coded = zlib.decompress(base64.b64decode(few.blocks.texts[halves["block"]]))
    assert len(coded) == 2 * every_third.size
    # what is shown of it has the scale of all of it
    assert few.cases[0]["white"] == whole.cases[0]["white"]
    assert few.blocks.size < 300_000
    none = choose_pictures(folder, rows, 1)
    assert [case["name"] for case in none.cases] == ["a"]
    assert none.left_out == ["b.exr"]


def test_what_there_was_no_room_for_is_named(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("experiments.report.report.choose_pictures", lambda *given: choose_pictures(*given, 1))
    page = Page(write_report(folder))
    assert "For 1 cases there was no room in this page; their pictures are in b.exr." in page.text


def test_columns(folder: Path) -> None:
    rows = [row("a", timing=1, **{"timing.ms": 1.5}), row("b", steps=9, **{"timing.ms": None, "scattering.flip": 0.25})]
    found = result_table(rows)
    names = [column.name for column in found.columns]
    assert names[:2] == ["case", "steps"]
    assert {"scene", "technique", "scattering.rel_50"} <= found.same.keys()
    assert found.same["scattering.rel_50"] == 0.012345678
    shown = {column.name for column in found.columns if column.shown}
    assert shown == {"case", "steps", "timing.ms", "scattering.flip"}
    cells = dict(zip(names, found.rows[0], strict=True))
    assert cells["timing.ms"] == 1.5
    assert dict(zip(names, found.rows[1], strict=True))["timing.ms"] is None
    assert [cell_text(value) for value in (0.012345678, 1e-7, 12345, "a", None)] == [
        "0.01235",
        "1e-07",
        "12345",
        "a",
        "",
    ]
    unlikely = result_table([row("a", extra=np.nan), row("b", extra=np.inf)])
    place = [column.name for column in unlikely.columns].index("extra")
    assert [values[place] for values in json.loads(json.dumps(unlikely.data, allow_nan=False))["rows"]] == [
        "nan",
        "inf",
    ]
    alone = result_table(rows[:1])
    assert {"scene", "technique", "scattering.rel_95"} <= {column.name for column in alone.columns}


def test_a_study_loads_no_picture_and_no_markup() -> None:
    text = (
        "**bold** <b onclick='x'>&</b> ![a](https://example.org/a.png) [b](javascript:alert(1))\n\n| a |\n|--|\n| 1 |"
    )
    html = study_text(Study("t", lambda table: iter(()), lambda table: text), polars.DataFrame())
    assert "<strong>bold</strong>" in html
    assert "<td>1</td>" in html
    assert not re.search(r"<b |<img|javascript:[^<]*\"", html)


def test_a_part_of_a_run_is_called_one(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("experiments.report.report.study_plots", lambda *given: [])
    record = json.loads((folder / "run.json").read_text())
    # one of the five cases failed, so that the run is not finished: all the same a page of five is whole
    heads = {7: "5 of 7 cases; the run was stopped", 5: "", None: "5 cases; the run was stopped"}
    for cases, words in heads.items():
        (folder / "run.json").write_text(json.dumps(record | {"cases": cases}))
        text = Page(write_report(folder)).text
        assert (words or "3 cases done") in text.split("3 cases done")[0] + "3 cases done"
        assert ("the run was stopped" in text) == bool(words)


def test_a_folder_whose_name_is_a_pattern(folder: Path) -> None:
    odd = folder.with_name("a[bc]*")
    shutil.copytree(folder, odd)
    assert [cells[0] for cells in Page(write_report(odd)).rows] == list("abcde")


def test_what_is_no_run_is_refused(folder: Path) -> None:
    (folder / "results.parquet").write_bytes(b"half of a table")
    with pytest.raises(
        InputError, match=r"is not a table that can be read: `airlight run SUITE --resume .*` writes it"
    ):
        write_report(folder)
    (folder / "run.json").unlink()
    with pytest.raises(InputError, match="is not the folder of a run"):
        write_report(folder)


def run_node(script: str) -> Any:
    """What a script made of the page's own decoder and colours answers."""
    sources = "".join((WEB / name).read_text() for name in ("decode.js", "colours.js"))
    done = subprocess.run(["node", "-e", sources + script], capture_output=True, text=True, timeout=60, check=True)
    return json.loads(done.stdout)


@pytest.mark.skipif(not shutil.which("node"), reason="needs Node.js to run the page's scripts outside a browser")
def test_scripts_decode_and_place_as_python_does() -> None:
    rng = np.random.default_rng(7)
    image = rng.standard_normal((5, 7, 3)) * 10.0 ** rng.uniform(-6, 3, (5, 7, 3))
    blocks = Blocks()
    halves = blocks.add(image)
    text = blocks.texts[halves.block]
    decoded = run_node(f"decode('{text}', {halves.exponent}, 7).then((v) => console.log(JSON.stringify([...v])))")
    expected = image.transpose(2, 0, 1)
    # below 2^-28 of the largest a half keeps less than 11 bits: measured 2^-39 of it
    smallest = 2.0**-38 * np.abs(expected).max()
    assert (np.abs(np.reshape(decoded, (3, 5, 7)) - expected) <= ROUNDING * np.abs(expected) + smallest).all()
    errors = [*np.linspace(-130, 130, 407), 0.0, 1e-3, -0.04]
    for scale in (Scale(100, True, 0.1), Scale(100, False, 0.1), Scale(20, True), Scale(20, False)):
        name = "vik" if scale.signed else "lajolla"
        told = json.dumps({"limit": scale.limit, "linear": scale.linear, "signed": scale.signed})
        shown = errors if scale.signed else np.abs(errors).tolist()
        found = run_node(
            f"const s = {told}, e = {json.dumps(shown)}, i = e.map((x) => colourIndex({ENTRIES}, s, x));"
            "console.log(JSON.stringify([e.map((x) => place(s, x)), ticks(s), i]))"
        )
        np.testing.assert_allclose(found[0], scale.place(shown), rtol=1e-12, atol=1e-15)
        np.testing.assert_allclose(found[1], scale.ticks(), rtol=1e-12)
        colours = colour_map(name)(scale.norm()(shown), bytes=True)[:, :3].astype(int)
        assert np.abs(table(colour_map(name))[found[2]] - colours).max() <= 1
