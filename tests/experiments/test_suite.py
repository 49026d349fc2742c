"""A suite is what its TOML file says, and what is wrong with it is said with its key and its line."""

from __future__ import annotations

import shutil
from itertools import pairwise
from pathlib import Path

import pytest

from experiments.suite import Case, cases_of, load_suite, shipped
from experiments.suite.reading import FOLDER
from reference.goal import Goal
from scenes.errors import InputError
from scenes.loader import load

SMALL = 'scenes = ["empty"]\nsize = [4, 5]\n[[techniques]]\nname = "Weng2010"\nsteps = 7\n'


@pytest.mark.parametrize("name", shipped())
def test_a_shipped_suite_has_scenes_that_take_its_parameters(name: str) -> None:
    found, loaded = load_suite(name)
    assert found == name
    cases = cases_of(loaded)
    assert len({case.name for case in cases}) == len(cases)
    # one of each scene: the others differ in numbers
    for case in {case.scene: case for case in cases}.values():
        load(case.scene, (4, 4), **case.parameters)


def test_every_suite_that_the_readme_names_is_there() -> None:
    assert {"quick", "gate", "paper", "phase", "downsampling", "aliasing", "timing"} <= set(shipped())


def test_quick_is_the_main_job() -> None:
    cases = cases_of(load_suite("quick")[1])
    names = ["Weng2010", "Nishita1987", "lit_intervals+quadrature"]
    expected = [(scene, name) for scene in ("empty", "sphere", "donut_dragon") for name in names]
    assert [(case.scene, case.technique.name) for case in cases] == expected
    assert {case.size for case in cases} == {(256, 256)}
    assert cases[1].technique.steps == 64


@pytest.mark.parametrize("name", ["aliasing", "timing"])
def test_the_grids_are_the_full_product(name: str) -> None:
    cases = [case for case in cases_of(load_suite(name)[1]) if case.product == "grid"]
    scenes = ("donut_dragon", "dragon", "yeahright", "many_objects", "wire_mesh")
    cells = {(case.scene, case.phase, case.technique.downsample, case.technique.name) for case in cases}
    techniques = {case.technique.name for case in cases}
    assert {"Nishita1987", "Weng2010", "lit_intervals+quadrature"} <= techniques
    expected = {
        (scene, phase, downsample, technique)
        for scene in scenes
        for phase in ("isotropic", "rayleigh", "hg 0.6")
        for downsample in (1, 2, 4, 8)
        for technique in techniques
    }
    assert cells == expected
    assert len(cases) == len(cells)


def test_a_path_is_taken_before_a_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = tmp_path / "mine.toml"
    shutil.copy(FOLDER / "quick.toml", own)
    assert load_suite(str(own))[0] == "mine"
    monkeypatch.chdir(tmp_path)
    (tmp_path / "quick").write_text(SMALL)
    assert cases_of(load_suite("quick")[1])[0].size == (4, 5)


def test_what_is_left_out_has_a_default(suite) -> None:
    (case,) = cases_of(suite(SMALL))
    assert case.reference.goal() == Goal(0.005, 600.0)
    assert case.parameters == {}
    assert (case.technique.steps, case.technique.downsample) == (7, 1)
    assert (case.name, case.phase, case.triangles, case.camera.frames) == ("empty-Weng2010-steps-7", "", None, 1)


def test_every_axis_multiplies(suite, monkeypatch: pytest.MonkeyPatch) -> None:
    text = """
scenes = ["empty", "sphere"]
size = [[4, 4], [8, 4]]
phases = ["isotropic", { name = "hg", g = 0.6 }]
parameters = { sigma_t = [0.1, 0.2, 0.3] }
cameras = [{}, { orbit = 2.0 }, { frames = 3, step = 0.5 }]
settings = { downsample = [1, 2], shadow_map = [64, 128] }
[[techniques]]
name = "Nishita1987"
steps = [4, 8, 16]
[[techniques]]
name = "Weng2010"
downsample = 4
"""
    cases = cases_of(suite(text))
    assert len(cases) == 2 * 2 * 2 * 3 * 3 * (3 * 2 * 2 + 2)
    one = next(
        case for case in cases if case.name.startswith("sphere-hg-0.6-sigma_t-0.2-8x4-path-0-to-1-in-3-Weng2010")
    )
    assert one.parameters == {"phase": "hg", "g": 0.6, "sigma_t": 0.2}
    assert (one.size, one.camera.angles(), one.technique.downsample) == ((8, 4), [0.0, 0.5, 1.0], 4)
    # counted without being made
    monkeypatch.setattr("experiments.suite.cases.MOST_CASES", len(cases))
    assert len(cases_of(suite(text))) == len(cases)
    monkeypatch.setattr("experiments.suite.cases.MOST_CASES", len(cases) - 1)
    with pytest.raises(InputError, match=f"to {len(cases):,} cases"):
        cases_of(suite(text))


def test_cases_of_one_view_follow_each_other() -> None:
    views = [case.view for case in cases_of(load_suite("phase")[1])]
    changes = sum(before != after for before, after in pairwise(views))
    assert changes == len(set(map(repr, views))) - 1


def test_a_product_takes_from_the_top_what_it_does_not_give(suite) -> None:
    text = SMALL + '[[products]]\nname = "a"\n[[products]]\nname = "b"\nsize = [8, 8]\nmeasure = "counts"\n'
    a, b = cases_of(suite(text))
    assert (a.name, a.size, a.measure) == ("a-empty-Weng2010-steps-7", (4, 5), ("errors",))
    assert (b.name, b.size, b.measure) == ("b-empty-Weng2010-steps-7", (8, 8), ("counts",))
    changed = cases_of(suite(text, "size=[16, 2]", "products.0.name=c"))
    assert [case.size for case in changed] == [(16, 2)] * 2
    assert changed[0].product == "c"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (SMALL + "colour = 1\n", "(line 6): the key 'techniques.0.colour'"),
        ("colour = 1\n" + SMALL, "(line 1): the key 'colour'"),
        (SMALL.replace("7", "0"), "(line 5): the key 'techniques.0.steps': steps is 0"),
        (SMALL.replace("7", "true"), "(line 5): the key 'techniques.0.steps"),
        (SMALL.replace("Weng2010", "Weng"), "(line 4): the key 'techniques.0.name': There is no technique 'Weng'"),
        (SMALL.replace("[4, 5]", "[\n  4,\n  0,\n]"), "(line 2): the key 'size"),
        (SMALL + "[settings]\nupsample = ['bilateral', 3]\n", "(line 7): the key 'settings.upsample.1'"),
        ("measure = ['beauty']\n" + SMALL, "(line 1): the key 'measure': there is no measurement 'beauty'"),
        ("study = 'x'\n" + SMALL, "(line 1): the key 'study': there is no study 'x'"),
        ("phases = [{ g = 0.6 }]\n" + SMALL, "(line 1): the key 'phases"),
        ("parameters = { size = 3 }\n" + SMALL, "use the suite's own key 'size'"),
        ("rounds = 1\n" + SMALL, "(line 1): the key 'rounds'"),
        ("time_limit = nan\n" + SMALL, "(line 1): the key 'time_limit'"),
        ("cameras = { frames = 0 }\n" + SMALL, "(line 1): the key 'cameras"),
        ("phases = 'isotropic'\nparameters = { phase = 'hg' }\n" + SMALL, "leave one out"),
        ("baseline = { name = 'Nishita1987', steps = [1, 2] }\n" + SMALL, "has several"),
        (SMALL + "[[products]]\nname = 'a'\nsizes = 3\n", "(line 8): the key 'products.0.sizes'"),
        ("products = 3\n" + SMALL, "(line 1): the key 'products'"),
        (SMALL + "[[techniques]]\nname = 'Weng2010'\nsteps = 7\n", "stands in the suite twice"),
        (SMALL.replace("empty", ""), "(line 1): the key 'scenes': '' is neither a scene's name"),
        (SMALL.replace("empty", "/"), "(line 1): the key 'scenes': '/' is neither a scene's name"),
        ("triangles = 9\ncameras = { frames = 2 }\n" + SMALL, "(line 1): the key 'triangles': a budget of triangles"),
        ("triangles = 9\ncameras = [{}, { orbit = 1 }]\n" + SMALL, "(line 1): the key 'triangles': a budget of"),
        ("rounds = " + "9" * 5000 + "\n" + SMALL, "is not a suite"),
        ("size = [4, 4]\nscenes = ['empty']\n", "the key 'techniques': Field required"),
        ("scenes = [\n", "is not a suite"),
    ],
)
def test_what_is_wrong_is_named_with_its_key_and_line(text: str, words: str, suite) -> None:
    with pytest.raises(InputError) as caught:
        cases_of(suite(text))
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_camera_that_stands_still_goes_with_a_budget_of_triangles(suite) -> None:
    (case,) = cases_of(suite("triangles = 9\ncameras = { frames = 1, step = 2 }\n" + SMALL))
    assert case.triangles == 9


def test_a_case_that_stands_there_twice_is_told_from_two_of_one_name(suite) -> None:
    with pytest.raises(InputError, match=r"^Two cases have the same name, x-y-Weng2010-steps-7: rename a product or a"):
        cases_of(suite(SMALL.replace('"empty"', '"x y", "x-y"')))
    products = "[[products]]\nname = 'a'\n[[products]]\nname = 'a'\n"
    with pytest.raises(InputError, match=r"^The case a-empty-Weng2010-steps-7 stands in the suite twice"):
        cases_of(suite(SMALL + products))
    with pytest.raises(InputError, match=r"^Two cases have the same name, a-empty-Weng2010-steps-7"):
        cases_of(suite(SMALL + products + "rounds = 4\n"))


def test_cameras_that_differ_have_names_that_differ(suite) -> None:
    cameras = [
        "{ orbit = 10.0000001 }",
        "{ orbit = 10.0000002 }",
        "{ orbit = 10 }",
        "{ frames = 3, step = 1 }",
        "{ frames = 5, step = 0.5 }",
        "{ orbit = 0.1, frames = 3, step = 0.1 }",
    ]
    cases = cases_of(suite(f"cameras = [{', '.join(cameras)}]\n" + SMALL))
    assert [str(case.camera) for case in cases] == [
        "orbit 10.0000001",
        "orbit 10.0000002",
        "orbit 10",
        "path 0 to 2 in 3",
        "path 0 to 2 in 5",
        "path 0.1 to 0.3 in 3",
    ]


def test_a_product_that_is_too_large_is_refused_before_it_is_made(suite) -> None:
    many = str([number / 1000 for number in range(400)])
    with pytest.raises(
        InputError, match=r"^The product 'grid' brings the suite to 64,000,000 cases, more than the 100,0"
    ):
        cases_of(suite(f"name = 'grid'\nparameters = {{ a = {many}, b = {many}, c = {many} }}\n" + SMALL))
    # products count together, and every axis counts
    text = SMALL.replace("7", str(list(range(1, 251)))) + f"[[products]]\nparameters = {{ a = {many} }}\n"
    with pytest.raises(InputError, match=r"^The product 'b' brings the suite to 100,250 cases"):
        cases_of(suite(text + "name = 'a'\n[[products]]\nname = 'b'\n"))


def test_paths_are_absolute_and_names_stay_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    here, beside = tmp_path / "here", tmp_path / "beside"
    for folder in (here, beside, here / "truth", beside / "truth", beside / "kept"):
        folder.mkdir()
    for path in (here / "a.xml", beside / "a.xml", beside / "b.xml"):
        path.write_text("")
    monkeypatch.chdir(here)
    text = 'scenes = ["a.xml", "b.xml", "empty", "none.xml"]\nsize = [4, 4]\ntechniques = [{ name = "Weng2010" }]\n'
    (beside / "mine.toml").write_text(text)

    def read(folder: str) -> list[Case]:
        return cases_of(load_suite("../beside/mine.toml", [f"reference.folder={folder}"])[1])

    assert [case.scene for case in read("truth")] == [
        str(here / "a.xml"),
        str(here / ".." / "beside" / "b.xml"),
        "empty",
        "none.xml",
    ]
    found = {folder: read(folder)[0].reference.folder for folder in ("truth", "kept", "none", str(beside / "kept"))}
    assert found == {
        "truth": str(here / "truth"),
        "kept": str(here / ".." / "beside" / "kept"),
        "none": str(here / ".." / "beside" / "none"),
        str(beside / "kept"): str(beside / "kept"),
    }


def test_a_long_name_is_cut_and_stays_its_own(suite) -> None:
    settings = ", ".join(f"{name} = [1.5, 2.5]" for name in (f"p{number}_{'x' * 30}" for number in range(5)))
    names = [case.name for case in cases_of(suite(f"parameters = {{ {settings} }}\n" + SMALL))]
    assert len(set(names)) == 32
    assert max(map(len, names)) <= 180
