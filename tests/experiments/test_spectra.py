"""`airlight spectra` writes what it measured, and the committed results are this code's."""

from __future__ import annotations

import csv
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from analytic import phase, spectra
from experiments.spectra import page as command
from experiments.spectra.errors import ANGLE, COEFFICIENTS, DEPTHS, MEDIA, ONE_PHASE, measure_medium
from scenes.errors import InputError

COMMITTED = Path(__file__).resolve().parents[2] / "results" / "spectra"
QUICK = {name: MEDIA[name] for name in ("air", "stained water")}


def read(folder):
    with (folder / "results.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("spectra") / "new" / "folder"
    return folder, command.write_spectra(folder, QUICK)


def test_a_row_a_medium_choice_quantity_and_depth(written):
    folder, rows = written
    assert len(rows) == len(QUICK) * len(COEFFICIENTS) * 2 * DEPTHS.size
    found = read(folder)
    assert len(found) == len(rows)
    for row, text in zip(rows, found, strict=True):
        assert {key: str(value) for key, value in row.items() if isinstance(value, str)}.items() <= text.items()
        assert float(text["delta_e"]) == row["delta_e"]
    for key in ("command", "date", "commit", "colour-science", "miepython"):
        assert all(text[key] for text in found)


def test_the_page_says_what_the_table_holds(written):
    folder, rows = written
    page = (folder / "README.md").read_text(encoding="utf-8")
    assert not re.search(r"[{}]", page)
    assert f"\n    {command.COMMAND}\n" in page
    chosen = {"medium": "air", "coefficients": "mean"}
    row = {
        row["quantity"]: row for row in rows if row["optical_depth"] == 1.0 and all(row[k] == chosen[k] for k in chosen)
    }
    cells = []
    for quantity in ("transmittance", "airlight"):
        cells += [f"{100 * row[quantity][f'relative_{channel}']:+.2f} %" for channel in spectra.CHANNELS]
        cells.append(f"{row[quantity]['delta_e']:.2f}")
    assert f"| air | 1 | {' | '.join(cells)} |" in page
    # 870 km of air let no blue of Rec.709 through
    deep = re.search(r"^\| air \| 10 \|(.*)$", page, re.MULTILINE)
    assert deep
    assert deep[1].split("|")[2].strip() == "outside"


def test_the_figure_is_drawn(written):
    folder, _ = written
    pixels = np.asarray(Image.open(folder / "errors.png").convert("RGB"))
    assert pixels.shape[0] > 500
    # red, green and blue lines are there
    for channel in range(3):
        others = np.delete(pixels.astype(int), channel, axis=2).max(axis=2)
        assert np.count_nonzero(pixels[..., channel] > others + 40) > 500


def test_airlight_is_that_of_the_stated_geometry():
    air = MEDIA["air"].make()
    distance = 1 / air.sigma_t[34]
    assert spectra.WAVELENGTHS[34] == 550
    # the light's foot on the ray is D cos 30 ahead of the eye, and the ray ends 2 D from it
    ray = (distance / 2, -distance * np.sqrt(0.75), 2 * distance - distance * np.sqrt(0.75))
    expected = spectra.airlight_error(air, air.medium(), *ray)
    row = next(r for r in measure_medium("air", air) if r["quantity"] == "airlight" and r["optical_depth"] == 1.0)
    assert np.degrees(ANGLE) == pytest.approx(30)
    assert row["distance"] == pytest.approx(distance, rel=1e-12)
    for number, channel in enumerate(spectra.CHANNELS):
        assert row[f"spectral_{channel}"] == pytest.approx(float(expected.spectral[number]), rel=1e-12)
        assert row[f"three_band_{channel}"] == pytest.approx(float(expected.three_band[number]), rel=1e-12)


def test_one_phase_function_leaves_the_error_of_the_coefficients():
    # a grey medium has none of that, however its phase functions differ
    flat = np.ones(spectra.WAVELENGTHS.size)
    tables = [phase("tabulated", values=(1.0, 1.0 + number / 40)) for number in range(flat.size)]
    rows = measure_medium("grey", spectra.SpectralMedium(flat, flat, tables))
    alone = [row["delta_e"] for row in rows if row["quantity"] == ONE_PHASE]
    both = [row["delta_e"] for row in rows if row["quantity"] == "airlight" and row["coefficients"] == "mean"]
    assert len(alone) == DEPTHS.size
    assert max(alone) < 1e-10
    # measured: 2.5 and more at depths of 3.2 and above
    assert min(both[-3:]) > 1


def test_the_committed_results_are_those_of_this_code(written):
    _, rows = written
    committed = [row for row in read(COMMITTED) if row["medium"] in QUICK]
    assert len(committed) == len(rows)
    assert {row["medium"] for row in read(COMMITTED)} == set(MEDIA)
    for row, text in zip(rows, committed, strict=True):
        assert (row["medium"], row["coefficients"], row["quantity"]) == (
            text["medium"],
            text["coefficients"],
            text["quantity"],
        )
        for key in (key for key, value in row.items() if isinstance(value, float)):
            # Delta E of two nearly equal colours is a difference of their last digits
            assert float(text[key]) == pytest.approx(row[key], rel=1e-9, abs=1e-11)


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path):
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="choose another --out"):
        command.write_spectra(tmp_path / "file" / "below", QUICK)


def test_without_miepython_the_command_says_the_cure(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "miepython", None)
    with pytest.raises(InputError, match=r"pip install 'airlight\[spectra\]'"):
        command.write_spectra(tmp_path, {"haze": MEDIA["haze"]})
    assert not list(tmp_path.iterdir())
