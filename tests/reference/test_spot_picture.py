"""A spot's picture in float64, against Mitsuba's own lookup, and where a ray crosses its texels."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from reference.deterministic.ray_spans import Rays
from reference.deterministic.spot_picture import looked_up, texel_crossings
from reference.integrator import mi
from scenes.model import Light, Texture

PIXELS = np.random.default_rng(3).random((5, 7, 3)).astype(np.float32)
TO_UV = np.array([[1.3, 0.2, -0.1], [-0.3, 0.9, 0.25]])


def picture(nearest: bool, wrap: str) -> Texture:
    return Texture(PIXELS, TO_UV, nearest, wrap, Path("none.exr"))  # type: ignore[arg-type]


@pytest.mark.parametrize("wrap", ["repeat", "mirror", "clamp"])
@pytest.mark.parametrize("nearest", [True, False], ids=["nearest", "bilinear"])
def test_it_is_mitsubas(nearest: bool, wrap: str) -> None:
    uv = np.random.default_rng(5).uniform(-2, 3, (500, 2)).astype(np.float32)
    bitmap = {"type": "bitmap", "data": mi.TensorXf(PIXELS), "raw": True, "wrap_mode": wrap}
    plugin = mi.load_dict(bitmap | {"filter_type": "nearest" if nearest else "bilinear"})
    si = mi.SurfaceInteraction3f()
    si.uv = mi.Point2f((uv @ TO_UV[:, :2].T.astype(np.float32) + TO_UV[:, 2].astype(np.float32)).T)
    ours, theirs = looked_up(picture(nearest, wrap), uv.astype(np.float64)), np.array(plugin.eval(si)).T
    off = np.abs(ours - theirs).max(axis=-1)
    # float32 coordinates: measured 2.0e-6, and 0 without interpolation; no place lies so close to a texel's edge that
    # float32 would put it on the other side
    assert off.max() < 1e-5


@pytest.mark.parametrize("nearest", [True, False], ids=["nearest", "bilinear"])
def test_crossings_are_where_the_texel_changes(nearest: bool) -> None:
    to_world = np.eye(4)
    to_world[:3, :3] = np.linalg.qr(np.random.default_rng(8).normal(size=(3, 3)))[0]
    to_world[:3, 3] = 0.3, 1.0, -0.2
    light = Light("spot", to_world[:3, 3], np.ones(3), to_world, 0.2, 0.6, picture(nearest, "repeat"))
    axis, side = light.direction, to_world[:3, 0]
    origin = light.position + 2 * axis + 0.9 * side
    direction = 0.2 * axis - side + 0.3 * to_world[:3, 1]
    direction /= np.linalg.norm(direction)
    rays = Rays(origin[None], direction[None], np.zeros(1), np.full(1, 2.0))
    piece, t = texel_crossings(light, rays, np.zeros(1, int), np.zeros(1), np.full(1, 2.0))
    assert (piece == 0).all()
    # by stepping
    steps = np.linspace(0, 2, 200_001)
    local = (origin + steps[:, None] * direction - light.position) @ to_world[:3, :3]
    uv = 0.5 + 0.5 * local[:, :2] / (local[:, 2:] * np.tan(0.6))
    texel = np.floor((uv @ TO_UV[:, :2].T + TO_UV[:, 2]) * [7, 5] - (0.0 if nearest else 0.5))
    changes = np.concatenate([steps[1:][np.diff(column) != 0] for column in texel.T])
    assert changes.size > 5
    np.testing.assert_allclose(np.sort(t), np.sort(changes), atol=1.1e-5)
