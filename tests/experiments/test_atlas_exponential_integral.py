"""The map of the exponential integral's errors: its table, its picture, and that it sees an error that is there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import polars
import pytest
from matplotlib.image import imread

from experiments.atlas import exponential_integral_map
from experiments.atlas.exponential_integral_map import PANELS, Panel, write_map


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exponential_integral_map, "FEW", 30)
    monkeypatch.setattr(exponential_integral_map, "MANY", 2_000)
    monkeypatch.setattr(exponential_integral_map, "RADII", np.geomspace(1e-6, 1e3, 13))
    monkeypatch.setattr(exponential_integral_map, "ANGLES", np.linspace(-180, 180, 13))


def table(folder) -> polars.DataFrame:
    picture, csv = write_map(folder)
    assert imread(picture).shape[:2] == (1100, 1200)
    return polars.read_csv(csv)


def test_table_and_picture(small, tmp_path) -> None:
    rows = table(tmp_path / "new")
    # eleven annuli; F and Ei in four quadrants by three and two implementations, Im F in two by three
    assert rows.height == 11 * (4 * (3 + 2) + 2 * 3)
    # measured over the full sample: 2.2e-15, 1.6e-6 and 1.8e-11
    for implementation, allowed in (("airlight float64", 4e-15), ("airlight float32", 3e-6), ("scipy float64", 1e-9)):
        worst = rows.filter(polars.col("implementation") == implementation)["worst_relative_error"]
        assert 0 < worst.max() < allowed
    # the worst point lies in its row's annulus and quadrant
    z = rows["at_real"].to_numpy() + 1j * rows["at_imaginary"].to_numpy()
    assert np.all((np.abs(z) >= rows["modulus_from"].to_numpy()) & (np.abs(z) < rows["modulus_to"].to_numpy()))
    names = {(1, 1): "I", (-1, 1): "II", (-1, -1): "III", (1, -1): "IV"}
    assert [names[np.sign(w.real), np.sign(w.imag)] for w in z] == rows["quadrant"].to_list()


def spoilt(panel: Panel) -> Panel:
    """The panel with values that are one part in a thousand too large in one annulus."""

    def evaluate(z):
        return panel.evaluate(z) * np.where((np.abs(z) > 45) & (np.abs(z) < 300), 1.001, 1.0)

    return replace(panel, evaluate=evaluate)


def test_a_wrong_value_is_seen(small, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(exponential_integral_map, "PANELS", tuple(map(spoilt, PANELS)))
    rows = table(tmp_path)
    there = polars.col("modulus_from") == 45
    assert rows.filter(there)["worst_relative_error"].to_numpy() == pytest.approx(1e-3, rel=0.01, abs=0)
    assert rows.filter(~there)["worst_relative_error"].max() < 1e-5


def test_what_overflows_or_is_not_asked_for_is_left_out() -> None:
    z = np.array([2 + 1j, -2 + 1j])
    truth = np.array([0.3 - 0.1j, 1e300])
    right = Panel("Im F", "ours float64", lambda value, exact: np.abs(value - exact), lambda points: truth[:1])
    assert np.array_equal(right.measure(z, truth), [0, np.nan], equal_nan=True)
    single = Panel("Ei", "ours float32", lambda value, exact: np.abs(value - exact), lambda points: truth[:1])
    assert np.array_equal(single.measure(z, truth), [0, np.nan], equal_nan=True)
