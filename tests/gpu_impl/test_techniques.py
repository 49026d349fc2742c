"""A technique's settings are what they can be, or are refused."""

from __future__ import annotations

import numpy as np
import pytest

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
