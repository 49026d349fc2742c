"""A technique's settings are what they can be, or are refused."""

from __future__ import annotations

import numpy as np
import pytest
from scene_files import point, spot, write_scene

from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.techniques import find_technique
from scenes.errors import InputError


@pytest.mark.parametrize("setting", ["steps", "shadow_map", "downsample"])
@pytest.mark.parametrize("value", [1.5, 4.0, True, "4", np.float32(4), np.bool_(True), [4], float("nan")])
def test_what_is_no_whole_number_is_refused(setting: str, value: object) -> None:
    with pytest.raises(InputError, match=f"{setting} is .*; use a whole number") as caught:
        find_technique("Weng2010", **{setting: value})
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("value", [4, np.int64(4), np.uint8(4)])
def test_whole_numbers_are_taken(value: int) -> None:
    assert find_technique("Nishita1987", steps=value, shadow_map=value, downsample=value).steps == 4


def test_another_part_is_another_cell() -> None:
    base = find_technique("Weng2010", steps=32)
    cell = find_technique("Weng2010", steps=32, airlight="riemann", visibility="uniform_march")
    assert (cell.name, cell.visibility, cell.airlight, cell.steps) == (
        "uniform_march+riemann",
        "uniform_march",
        "riemann",
        32,
    )
    # named as what it is already
    assert find_technique("Weng2010", steps=32, visibility=base.visibility, airlight=base.airlight) == base
    assert find_technique("Nishita1987", visibility="lit_intervals").name == "lit_intervals+riemann"


def test_every_model_of_the_thesis_is_a_variant_by_name() -> None:
    for model in AIRLIGHT_MODELS:
        if model.startswith("weng2010:"):
            technique = find_technique(model.replace("weng2010", "Weng2010"))
            assert technique.airlight == model
            assert technique.visibility == ("lit_intervals:printed" if model.endswith(":printed") else "lit_intervals")


@pytest.mark.parametrize("setting", ["visibility", "airlight", "upsample", "surface_shadows", "composition"])
@pytest.mark.parametrize("value", ["no such", "", 3, None.__class__, ["bilateral"]])
def test_what_is_none_of_the_choices_is_refused(setting: str, value: object) -> None:
    with pytest.raises(InputError, match=r"There is no .*; use one of ") as caught:
        find_technique("Weng2010", **{setting: value})
    assert "\n" not in str(caught.value)


def test_a_soft_spot_under_a_closed_form_is_said(tmp_path) -> None:
    soft = write_scene(tmp_path, spot("0.3, 3.5, 0", "0, 0, 0", 24, 12))
    (notice,) = find_technique("Weng2010").notices(soft)
    assert "takes a spot's intensity as constant" in notice
    assert "lit_intervals+quadrature" in notice
    assert find_technique("lit_intervals+quadrature").notices(soft) == []
    assert find_technique("Weng2010").notices(write_scene(tmp_path, spot("0.3, 3.5, 0", "0, 0, 0", 24, 24))) == []


def test_fog_by_depth_alone_beside_a_light_is_said(tmp_path) -> None:
    """Ten times too bright at a fortieth of a mean free path: the fog's is 10."""
    beside, away = (write_scene(tmp_path, point(0, 0, 5 - z)) for z in (0.2, 0.4))
    (notice,) = find_technique("James2003").notices(beside)
    assert "too bright" in notice
    assert "shadow_faces+quadrature" in notice
    assert find_technique("James2003").notices(away) == []
    assert find_technique("shadow_faces+quadrature").notices(beside) == []
