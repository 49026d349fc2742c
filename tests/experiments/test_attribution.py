"""Coalitions, their pictures and their float64, end to end."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
import polars
import pytest
from registries import restored_registries
from rich.console import Console
from scene_files import point, sphere, spot, write_scene

import airlight as face
from experiments.attribution import float64
from experiments.attribution.coalitions import (
    FLOAT32,
    LATTICE,
    MODEL,
    PARTS,
    SHADOW_MAP,
    VISIBILITY,
    parts_of,
    replaced,
)
from experiments.attribution.measurement import attribute
from experiments.attribution.page import FILES
from experiments.attribution.pictures import Pictures
from experiments.attribution.planted import LEAST, PLANTED, Planted, planted_table, try_planted
from experiments.attribution.shapley import coalitions
from experiments.attribution.split import Share
from experiments.attribution.tables import other_surfaces
from gpu_impl.shader_source import SHADERS
from gpu_impl.techniques import TECHNIQUES, Technique, find_technique
from scenes.errors import InputError
from scenes.model import Scene

ALL = frozenset(PARTS)
SIZE = (32, 32)
MARCH = {"steps": 32, "shadow_map": 128}


@pytest.fixture(scope="module")
def ball() -> Scene:
    return face.load("sphere", SIZE)


@pytest.fixture(scope="module")
def pictures(ball: Scene) -> Iterator[Pictures]:
    with Pictures(ball) as found:
        yield found


def exact(*parts: str) -> frozenset[str]:
    return frozenset(parts)


def test_every_coalition_of_a_technique_with_all_parts_is_another_cell(ball: Scene) -> None:
    technique = find_technique("Weng2010", downsample=4)
    assert parts_of(technique, ball).there == PARTS
    assert parts_of(technique, ball).left_out == {}
    without_float32 = [one for one in coalitions(PARTS) if FLOAT32 not in one]
    assert len({replaced(technique, one) for one in without_float32}) == 16
    assert replaced(technique, exact()) is technique
    assert replaced(technique, exact(FLOAT32)) is technique


def test_what_replaces_a_part(ball: Scene) -> None:
    technique = find_technique("Weng2010", downsample=4, shadow_map=256)

    def cell(*parts: str) -> tuple[str, str, str, int]:
        found = replaced(technique, exact(*parts))
        assert (found.shadow_map, found.steps, found.upsample) == (256, technique.steps, technique.upsample)
        return found.visibility, found.airlight, found.shadow_source, found.downsample

    assert cell(MODEL) == ("lit_intervals", "quadrature", "map", 4)
    assert cell(VISIBILITY) == ("exact", "one_ei", "map", 4)
    assert cell(SHADOW_MAP) == ("lit_intervals", "one_ei", "rays", 4)
    assert cell(VISIBILITY, SHADOW_MAP) == ("given", "one_ei", "map", 4)
    assert cell(LATTICE) == ("lit_intervals", "one_ei", "map", 1)
    assert cell(*PARTS) == ("given", "quadrature", "map", 1)


@pytest.mark.parametrize("name", TECHNIQUES)
def test_all_parts_of_every_technique_become_the_same_cell(name: str, ball: Scene) -> None:
    technique = find_technique(name)
    parts = parts_of(technique, ball)
    assert {*parts.there, *parts.left_out} == ALL
    found = replaced(technique, frozenset(parts.there))
    assert (found.visibility, found.airlight, found.lattice, found.downsample) == ("given", "quadrature", "grid", 1)


@pytest.mark.parametrize(
    ("name", "settings", "left_out"),
    [
        ("given+quadrature", {}, {MODEL, VISIBILITY, SHADOW_MAP, LATTICE}),
        ("exact+one_ei", {"downsample": 2}, {VISIBILITY}),
        ("uniform_march+riemann", {"shadow_source": "rays"}, {SHADOW_MAP, LATTICE}),
        ("James2003", {}, {SHADOW_MAP, LATTICE}),
        ("Dobashi2002", {}, {LATTICE, FLOAT32}),
        ("Chen2011", {}, {MODEL}),
    ],
)
def test_parts_that_do_not_apply_are_named_with_their_reason(
    name: str, settings: dict[str, object], left_out: set[str], ball: Scene
) -> None:
    parts = parts_of(find_technique(name, **settings), ball)
    assert set(parts.left_out) == left_out
    assert all(parts.left_out.values())
    assert parts.there == tuple(part for part in PARTS if part not in left_out)


def test_exact_without_a_map_is_given(ball: Scene) -> None:
    assert replaced(find_technique("exact+one_ei"), exact(SHADOW_MAP)).visibility == "given"
    assert replaced(find_technique("James2003"), exact(VISIBILITY)).visibility == "given"


def rounding(pictures: Pictures, technique: Technique, *parts: str) -> float:
    """The largest difference of a picture from its twin in float64, over the brightest pixel."""
    drawn, twin = (pictures.draw(technique, exact(*parts, *more)) for more in ((), (FLOAT32,)))
    return float(np.abs(twin - drawn).max() / drawn.max())


MODELS = [
    *("quadrature", "riemann", "depth_fog", "one_ei", "sun2005", "sun2005:512"),
    *("weng2010", "weng2010:printed", "weng2010:four-ei", "weng2010:three-ei", "weng2010:two-ei"),
    *("weng2010:taylor", "weng2010:minimax"),
]


@pytest.mark.parametrize("model", MODELS)
def test_float64_is_what_the_shader_rounds(model: str, pictures: Pictures) -> None:
    technique = find_technique(f"lit_intervals:unbounded+{model}", steps=32, shadow_map=128)
    # measured: 3e-7 (riemann) to 2e-6 (weng2010:printed)
    assert 0 < rounding(pictures, technique) < 6e-6


@pytest.mark.parametrize("beam", [25, 15])
def test_float64_knows_spots_and_several_lights(beam: int, tmp_path: Path) -> None:
    emitters = spot("1, 3, 1", "0, 0, 0", 25, beam) + point(-2, 1, 1)
    scene = write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), emitters=emitters, size=SIZE)
    with Pictures(scene) as pictures:
        for model in ("quadrature", "riemann", "one_ei", "depth_fog"):
            technique = find_technique(f"uniform_march+{model}", steps=16, downsample=2, shadow_map=128)
            # measured: 2e-6, and 2.0e-4 where the shader's nodes meet the kink at the beam's edge
            limit = 6e-4 if model == "quadrature" and beam < 25 else 6e-6
            for more in ((), (VISIBILITY, SHADOW_MAP)):
                assert rounding(pictures, technique, *more) < limit


@pytest.mark.parametrize("name", ["sun_in_a_box", "lamp_outside"])
def test_float64_knows_other_lights_and_bodies_of_fog(name: str, others: Path) -> None:
    with Pictures(face.load(others / f"{name}.xml", SIZE)) as pictures:
        for model in ("quadrature", "riemann"):
            technique = find_technique(f"uniform_march+{model}", steps=16, shadow_map=128)
            # measured: 4e-6 for point samples, 1.1e-4 for the shader's rule where a ray only grazes the fog
            limit = 4e-4 if model == "quadrature" else 1.3e-5
            for more in ((), (VISIBILITY, SHADOW_MAP)):
                assert rounding(pictures, technique, *more) < limit


def test_float64_through_another_lattice(pictures: Pictures) -> None:
    # measured: 1e-6
    assert rounding(pictures, find_technique("Chen2011", shadow_map=128)) < 3e-6


def test_float64_of_depth_fog(pictures: Pictures) -> None:
    # pieces of the whole ray behind each face, of either sign, whose sum is smaller than they are; measured: 4e-7
    assert rounding(pictures, find_technique("James2003")) < 2e-6


def test_float64_weighs_pieces(pictures: Pictures) -> None:
    # a shifted march weighs what is left of its cut step; measured: 5e-7
    technique = find_technique("uniform_march:blue_noise+riemann", steps=16, shadow_map=128)
    assert rounding(pictures, technique) < 2e-6


def test_many_pieces_are_evaluated_a_chunk_at_a_time(pictures: Pictures, monkeypatch: pytest.MonkeyPatch) -> None:
    technique = find_technique("uniform_march:blue_noise+riemann", steps=16, shadow_map=128)
    whole = pictures.draw(technique, exact(FLOAT32))
    monkeypatch.setattr(float64, "CHUNK", 1000)
    np.testing.assert_allclose(pictures.draw(technique, exact(FLOAT32)), whole, rtol=1e-14)


def test_exact_parts_are_the_reference(ball: Scene, pictures: Pictures) -> None:
    truth = face.reference(ball, deterministic=True).scattering
    for name in ("Weng2010", "Nishita1987", "James2003", "Dobashi2002"):
        technique = find_technique(name)
        found = pictures.draw(technique, frozenset(parts_of(technique, ball).there))
        # rays end where OpenGL's do, whose depth is off most at the ball's rim; measured: 1.1e-5
        np.testing.assert_allclose(found, truth, rtol=4e-5)
        if name != "Dobashi2002":
            # with float32; half of the rays end on the far plane. Measured: 1e-10
            assert np.percentile(np.abs(found / truth - 1), 50) < 1e-9


def test_point_samples_in_steps() -> None:
    # nothing is dark, so that the one lit interval is the whole ray, and its steps are those of a march
    scene = face.load("empty", SIZE)
    with Pictures(scene) as pictures:
        march = find_technique("Nishita1987", steps=16)
        own = pictures.draw(march, exact())
        for parts in ((VISIBILITY,), (VISIBILITY, SHADOW_MAP)):
            assert replaced(march, exact(*parts)).visibility == ("exact:steps", "given:steps")[len(parts) - 1]
            for more in ((), (FLOAT32,)):
                # measured: 7e-7
                np.testing.assert_allclose(pictures.draw(march, exact(*parts, *more)), own, rtol=3e-6)
        # one sample of all of the ray is another picture
        assert (np.abs(pictures.draw(find_technique("exact+riemann", steps=16), exact()) / own - 1) > 0.1).mean() > 0.5


def test_a_model_of_ones_own_that_samples_points_keeps_its_share(
    tmp_path: Path, ball: Scene, pictures: Pictures
) -> None:
    truth = face.reference(ball, deterministic=True)
    (tmp_path / "copied.glsl").write_text((SHADERS / "airlight/riemann.glsl").read_text())
    shares = {}
    with restored_registries():
        for says in ("", ", point_samples = true"):
            file = tmp_path / "mine.toml"
            file.write_text(
                f'name = "Mine"\nvisibility = "uniform_march"\nairlight = {{ file = "copied.glsl"{says} }}\n'
            )
            own = attribute(pictures, find_technique(str(file), **MARCH), truth)
            assert tuple(own.parts.left_out) == (LATTICE, FLOAT32)
            shares[says] = {part: own.split.fraction(share) for part, share in own.split.parts.items()}
    found = attribute(pictures, find_technique("Nishita1987", **MARCH), truth).split
    registered = {part: found.fraction(found.parts[part]) for part in shares[""]}
    # measured: 7e-6, which is float32's share
    assert shares[", point_samples = true"] == pytest.approx(registered, abs=3e-5)
    # one sample of a whole lit interval is charged to the model 880 times over
    assert shares[""][MODEL] > 100 * registered[MODEL]


def test_other_surfaces_are_charged_to_no_part() -> None:
    scene = face.load("wire_mesh", (48, 48))
    truth = face.reference(scene, deterministic=True)
    with Pictures(scene) as pictures:
        found = attribute(pictures, find_technique("exact+quadrature"), truth)
        elsewhere = pictures.other_surfaces
    # one pixel, with 99.7 % of the squared error
    assert 0 < elsewhere.sum() < 5
    assert found.in_other_surfaces > 0.9

    def part_elsewhere(share: Share) -> float:
        return float(np.sum(share.signed[elsewhere] ** 2) / np.sum(share.signed**2))

    # measured: 0 and 1 - 2e-11
    assert part_elsewhere(found.split.parts[SHADOW_MAP]) < 0.1
    assert part_elsewhere(found.split.remains) > 0.999
    assert "In 1 of 2304 pixels" in other_surfaces([found])


@pytest.mark.parametrize(
    ("name", "settings"),
    [("Nishita1987", {"steps": 16, "shadow_map": 128}), ("Weng2010", {"shadow_map": 64, "downsample": 2})],
)
def test_parts_add_up(name: str, settings: dict[str, int], ball: Scene, pictures: Pictures) -> None:
    truth = face.reference(ball, rel_error=0.02)
    found = attribute(pictures, find_technique(name, **settings), truth)
    parts = found.split.parts.values()
    scale = sum(abs(share.value) for share in (*parts, found.split.remains))
    total = sum(share.value for share in parts) + found.split.remains.value
    assert abs(total - found.split.whole.value) < 1e-14 * scale
    signed = sum(share.signed for share in parts) + found.split.remains.signed
    np.testing.assert_allclose(signed, found.split.whole.signed, rtol=0, atol=1e-15)
    # nothing but noise is left
    assert found.split.remains.is_noise
    assert not found.split.together.is_noise


def test_the_public_face(ball: Scene) -> None:
    truth = face.reference(ball, deterministic=True)
    found = face.attribute(ball, truth, "lit_intervals+quadrature", steps=16, shadow_map=64)
    assert (found.technique.steps, found.parts.there) == (16, (VISIBILITY, SHADOW_MAP, FLOAT32))
    with pytest.raises(InputError, match="another scene"):
        face.attribute(face.load("sphere", SIZE, sigma_t=0.2), truth)


@pytest.mark.parametrize("planted", PLANTED, ids=lambda planted: planted.name)
def test_a_planted_error_shows_up_in_its_own_part_and_in_no_other(planted: Planted) -> None:
    outcome = try_planted(planted)
    assert outcome.is_noticed
    assert outcome.own_share > LEAST
    for part in {*PARTS} - {planted.part}:
        assert replace(outcome, planted=replace(planted, part=part)).own_share < 1 - LEAST
    assert outcome.after.split.whole.value > outcome.before.split.whole.value


def test_what_hardly_changes_the_picture_is_charged_to_no_part() -> None:
    planted = Planted("two texels more", SHADOW_MAP, "Weng2010", "Weng2010", {}, {"shadow_map": 1026})
    outcome = try_planted(planted)
    assert not outcome.is_noticed
    assert np.isnan(outcome.own_share)
    told = Console(width=150, record=True, file=StringIO())
    told.print(planted_table([outcome]))
    (line,) = (line for line in told.export_text().splitlines() if "two texels" in line)
    assert line.split()[:-1] == [*["two", "texels", "more", "shadow", "map"], *"-----"]


def test_a_cell_that_a_control_cannot_take_is_told(
    ball: Scene, pictures: Pictures, monkeypatch: pytest.MonkeyPatch
) -> None:
    draw = Pictures.draw

    def refuse(self: Pictures, technique: object, coalition: frozenset[str]) -> np.ndarray:
        if {VISIBILITY, MODEL} <= coalition:
            raise InputError("Not with this light.")
        return draw(self, technique, coalition)

    monkeypatch.setattr(Pictures, "draw", refuse)
    truth = face.reference(ball, deterministic=True)
    with pytest.raises(InputError, match=r"Weng2010 cannot be split.* exact airlight model and visibility: Not with"):
        attribute(pictures, find_technique("Weng2010"), truth)


def test_the_command_writes_its_page(airlight, tmp_path: Path) -> None:
    words = ("attribute", "sphere", "--size", 32, 32, "--rel-error", 0.02, "--out", "there")
    result = airlight(*words, "--technique", "Weng2010", "--technique", "James2003")
    assert result.code == 0, result.err
    assert "James2003" in result.out
    assert sorted(path.name for path in (tmp_path / "there").iterdir()) == sorted(FILES)
    page = (tmp_path / "there" / "README.md").read_text()
    assert "airlight attribute sphere --technique Weng2010 --technique James2003 --size 32 32" in page
    assert "- shadow map: `shadow_faces` reads no shadow map." in page
    table = polars.read_parquet(tmp_path / "there" / "results.parquet")
    assert table.equals(polars.read_csv(tmp_path / "there" / "results.csv", schema=table.schema))
    kept = json.loads((tmp_path / "there" / "results.json").read_text())
    weng, james = kept["techniques"]
    for one in (weng, james):
        mine = table.filter(polars.col("technique") == one["technique"]["technique"])
        values = {row["part"]: row["squared_error"] for row in mine.iter_rows(named=True)}
        parts = [value for part, value in values.items() if part in PARTS and value is not None]
        assert sum(parts) == pytest.approx(values["parts together"], rel=1e-9, abs=1e-20)
        assert values["parts together"] + values["remains"] == pytest.approx(values["whole"], rel=1e-9)
        assert one["squared_error_with_exact"][""] == pytest.approx(values["whole"], rel=1e-12)
    assert len(weng["squared_error_with_exact"]) == 16
    assert set(james["left_out"]) == {SHADOW_MAP, LATTICE}
    assert "In none of the 1024 pixels OpenGL and the reference see surfaces" in page


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "attribute needs a SCENE, or --planted."),
        (("--planted", "--steps", "3"), "--planted has scenes and techniques of its own; leave --steps out."),
        (("sphere", "--technique", "Weng2011"), "There is no technique 'Weng2011'"),
        (("sphere", "-p", "phase=hg", "--technique", "Weng2010"), "The airlight model one_ei takes the phase function"),
        (("sphere", "--rel-error", "-1"), "-1"),
        (("sphere", "--size", "7", "9"), "An error is split over at least 64 pixels; ask for a larger picture."),
    ],
)
def test_refusals_are_one_sentence(words: tuple[str, ...], said: str, airlight) -> None:
    result = airlight("attribute", *words)
    assert result.code == 2
    assert said in result.err
    assert len(result.err.strip().splitlines()) == 1
