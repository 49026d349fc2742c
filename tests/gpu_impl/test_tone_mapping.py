"""Tone mapping: Reinhard et al. 2002 in NumPy, and sRGB by colour-science."""

from __future__ import annotations

import colour
import numpy as np
import pytest

from gpu_impl.context import shared_context
from gpu_impl.device import Device
from gpu_impl.passes.tone_mapping import tone_map
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from scenes.loader import load

WIDTH, HEIGHT = 256, 64


def encoded(picture: np.ndarray, exposure: float) -> np.ndarray:
    """What a display shows, 0 to 1, in float64."""
    exposed = exposure * np.maximum(picture.astype(float), 0)
    luminance = (exposed @ colour.RGB_COLOURSPACES["sRGB"].matrix_RGB_to_XYZ[1])[..., None]
    mapped = exposed * (1 + luminance / 4**2) / (1 + luminance)
    return colour.cctf_encoding(np.minimum(mapped, 1), function="sRGB")


def displayed(picture: np.ndarray, exposure: float) -> np.ndarray:
    """The same by the shader, (H, W, 3) uint8."""
    device = Device(shared_context())
    composite, display = device.texture((WIDTH, HEIGHT), 4), device.texture((WIDTH, HEIGHT), 4, "f1")
    composite.write(np.pad(picture, ((0, 0), (0, 0), (0, 1))).astype(np.float32).tobytes())
    tone_map(device, display, composite, exposure)
    found = np.frombuffer(display.read(), np.uint8).reshape(HEIGHT, WIDTH, 4)
    device.give_back(composite, display)
    device.release()
    assert (found[..., 3] == 255).all()
    return found[..., :3]


@pytest.mark.parametrize("exposure", [0.25, 1.0, 8.0])
@pytest.mark.parametrize("grey", [True, False], ids=["grey", "coloured"])
def test_every_colour_is_the_publications(grey: bool, exposure: float) -> None:
    random = np.random.default_rng(4)
    picture = np.exp(random.uniform(np.log(1e-5), np.log(30), (HEIGHT, WIDTH, 1 if grey else 3)))
    picture = np.broadcast_to(picture, (HEIGHT, WIDTH, 3))
    exact, found = encoded(picture, exposure), displayed(picture, exposure)
    # rounded to the nearest of 256 steps: half a step, and what the driver's pow adds; measured 0.500005
    assert np.abs(255 * exact - found).max() < 0.505
    assert len(np.unique(found)) > 200


def test_black_white_and_what_lies_beyond() -> None:
    picture = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    picture[:, 64:128], picture[:, 128:192], picture[:, 192:] = 4.0, 1e6, -1.0
    found = displayed(picture, 1.0)
    assert (found[:, :64] == 0).all()
    assert (found[:, 64:192] == 255).all()
    assert (found[:, 192:] == 0).all()


@pytest.mark.parametrize("exposure", [0.0, -1.0, np.inf, np.nan])
def test_an_exposure_that_shows_nothing_is_refused(exposure: float) -> None:
    with pytest.raises(ValueError, match="exposure must be positive"):
        displayed(np.zeros((HEIGHT, WIDTH, 3)), exposure)


def test_a_picture_is_the_frame_and_leaves_it_as_it_is() -> None:
    technique = find_technique("Weng2010", steps=16, shadow_map=64)
    with Renderer(load("sphere", size=(48, 32))) as renderer:
        before = renderer.render(technique)
        picture = renderer.picture(technique, exposure=2.0)
        after = renderer.render(technique)
        with pytest.raises(ValueError, match="exposure must"):
            renderer.picture(technique, exposure=0.0)
    assert picture.shape == (32, 48, 3)
    assert picture.dtype == np.uint8
    assert np.abs(255 * encoded(before.composite, 2.0) - picture).max() < 0.505
    assert (before.composite == after.composite).all()
