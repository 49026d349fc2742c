"""`airlight figures`: which figures there are, what their files say, and that they show what they name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from experiments.figures import FIGURES, LEFT_OUT, artefacts, models, results, stage, table_5_1
from experiments.figures.entry import Drawn
from experiments.figures.panels import scattering_error
from experiments.figures.rays import RayField
from experiments.figures.stage import Stage
from experiments.metrics import measure
from gpu_impl.frame import Frame

SMALL = ["--size", "48", "48"]
ASKED_FOR = [
    *("1.1", "1.2", "1.4", "1.5", "1.6", "2.1", "2.3"),
    *(f"4.{one}" for one in range(1, 9)),
    *("5.1", "5.2", "5.3", "5.4", "table-5.1"),
]
CHAPTERS = {1: 6, 2: 3, 3: 6, 4: 11, 5: 4}


def test_the_registry_has_every_figure_once() -> None:
    assert list(FIGURES) == ASKED_FOR
    thesis = {f"{chapter}.{one}" for chapter, last in CHAPTERS.items() for one in range(1, last + 1)} | {"table-5.1"}
    assert set(FIGURES) | set(LEFT_OUT) == thesis
    assert not set(FIGURES) & set(LEFT_OUT)
    assert [entry.page for entry in FIGURES.values()] == sorted(entry.page for entry in FIGURES.values())
    assert FIGURES["table-5.1"].name == "Table 5.1"
    assert FIGURES["5.1"].stem == "figure-5.1"


@pytest.mark.parametrize(("number", "said"), [("9.9", "There is no figure '9.9'"), ("3.1", "Figure 3.1 is left out")])
def test_a_figure_that_is_not_there(airlight: Any, number: str, said: str) -> None:
    answer = airlight("figures", "--only", number, *SMALL)
    assert answer.code == 2
    assert answer.err.count("\n") == 1
    assert said in answer.err
    assert all(known in answer.err for known in FIGURES)
    assert not Path("runs").exists()


def test_a_page_of_somebody_else_is_left_alone(airlight: Any, tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text("# mine\n")
    answer = airlight("figures", "--only", "4.6", *SMALL, "--out", str(tmp_path))
    assert answer.code == 2
    assert "is another page" in answer.err


def test_files_say_how_they_were_made(airlight: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stage, "FIELD_SIDE", 64)
    monkeypatch.delenv("AIRLIGHT_MESH_DIR", raising=False)
    answer = airlight("figures", "--only", "4.6", "--only", "4.2", *SMALL, "--out", str(tmp_path / "paper"))
    assert answer.code == 0, answer.err
    names = {path.name for path in (tmp_path / "paper").iterdir()}
    assert names == {f"figure-{number}.{kind}" for number in ("4.2", "4.6") for kind in ("png", "pdf")}
    said = Image.open(tmp_path / "paper" / "figure-4.6.png").text
    assert "command: airlight figures --only 4.6 --only 4.2 --size 48 48" in said["Comment"]
    for word in ("commit: ", "mitsuba: ", "renderer: ", "date: 20"):
        assert word in said["Comment"]
    assert said["Title"].startswith("Weng 2010, Figure 4.6")
    # a mesh that is not here: said in the terminal and in both files
    assert "stand-ins served for dragon_97k_fixed.ply" in " ".join(answer.err.split())
    assert "stand-ins: dragon_97k_fixed.ply" in said["Comment"]
    assert b"stand-ins: dragon_97k_fixed.ply" in (tmp_path / "paper" / "figure-4.6.pdf").read_bytes()


def pixels(drawn: Drawn) -> np.ndarray:
    canvas = FigureCanvasAgg(drawn.figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba()).copy()


@pytest.fixture(scope="module")
def small() -> Any:
    with pytest.MonkeyPatch.context() as patch, Stage((48, 48)) as made:
        patch.setattr(stage, "FIELD_SIDE", 64)
        yield made


@pytest.mark.parametrize("draw", [results.final_results_1, artefacts.too_dark])
def test_a_figure_shows_the_technique(small: Stage, draw: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    right = draw(small)
    shown = pixels(right)
    assert np.array_equal(shown, pixels(draw(small)))
    frame = Stage.frame

    def wrong(self: Stage, scene: Any, technique: str, **settings: Any) -> Frame:
        return frame(self, scene, "FrontFinal" if technique == "Weng2010" else technique, **settings)

    monkeypatch.setattr(Stage, "frame", wrong)
    mistaken = draw(small)
    assert (shown != pixels(mistaken)).any(-1).mean() > 0.001
    assert right.text != mistaken.text


def test_the_picture_of_models_is_the_reference(small: Stage) -> None:
    """The same lit pieces through the same model as the deterministic reference's own quadrature."""
    pieces = models.Pieces.of_subject(small)
    scene = small.field("donut_dragon").scene
    image = pieces.picture(small, pieces.radiance(small, "quadrature", "isotropic", np.float64))
    truth = small.reference(scene).scattering
    lit = truth > 0.01 * truth.max()
    # measured: 1.4e-14
    np.testing.assert_allclose(image[lit], truth[lit], rtol=1e-10)


def test_models_stand_on_one_scale(small: Stage) -> None:
    drawn = models.models_compared(small)
    norms = [image.norm for axes in drawn.figure.axes for image in axes.images if image.get_array().ndim == 2]
    assert len({(norm.vmin, norm.vmax) for norm in norms}) == len(models.SHOWN)
    assert "Lecocq" in drawn.text


def test_the_table_has_published_and_timed_rates(small: Stage, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table_5_1, "SIDE", 32)
    monkeypatch.setattr(table_5_1, "TABLE_5_1", {"sphere": (6, 23)})
    monkeypatch.setattr(table_5_1, "TRIANGLES", 10**6)
    with Stage((32, 32)) as made:
        drawn, found = table_5_1.frame_rates(made), table_5_1.rates(made)
    assert [(one.phase, one.published) for one in found] == [("rayleigh", 6), ("isotropic", 23)]
    for one in found:
        for name in table_5_1.TIMED:
            middle, low, high = one.frames_a_second(name)
            assert 0 < low <= middle <= high
            assert len(one.milliseconds[name]) == table_5_1.ROUNDS
            assert f"{middle:.1f} [{low:.1f}, {high:.1f}]" in drawn.text


def test_errors_are_those_of_the_metrics(small: Stage) -> None:
    scene = small.scene("donut_dragon")
    frame, truth = small.frame(scene, "Nishita1987"), small.reference(scene)
    measured = measure(frame.scattering, truth.scattering)
    found = scattering_error(frame, truth)
    assert all(getattr(measured, name) == value for name, value in vars(found).items())


def test_things_are_made_once(small: Stage) -> None:
    scene = small.scene("sphere")
    assert small.scene("sphere") is scene
    assert small.frame(scene, "Weng2010") is small.frame(scene, "Weng2010")
    assert small.frame(scene, "Weng2010") is not small.frame(scene, "Weng2010", steps=5)
    assert isinstance(small.field("donut_dragon"), RayField)
