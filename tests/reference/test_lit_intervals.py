"""Lit intervals against shadows that are known in closed form, ray by ray."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from oracles import SphereScene, cone_interval
from scene_files import point, sphere, spot, write_scene
from shadow_volumes import SHADOWS, Interval
from slab import BOTTOM, TOP, VIEWS, slab_scene

from reference.deterministic import probes
from reference.deterministic.lit_intervals import LitIntervals, Search, lit_intervals, search
from reference.deterministic.ray_spans import Rays
from reference.deterministic.shadow_rays import ShadowRays
from scenes.loader import load
from scenes.model import Scene


def searched(scene: Scene, **settings) -> Search:
    shadow_rays = ShadowRays(scene)
    return search(shadow_rays, Rays.of_camera(scene, shadow_rays.t_end()), scene, **settings)


def sphere_shadows(scene: Scene, t_end: np.ndarray) -> list[Interval]:
    return SphereScene(scene).shadows


CASES: dict[str, Callable[[Scene, np.ndarray], list[Interval]]] = SHADOWS | {"sphere": sphere_shadows}


def missed_and_invented(scene: Scene, found: LitIntervals) -> tuple[np.ndarray, np.ndarray]:
    """Places on each ray, (pixels, 400) bool, that are lit and not found, and found and not lit.

    Places within the errors of the ends that were found are left out.
    """
    t_end = ShadowRays(scene).t_end().reshape(scene.camera.height, scene.camera.width)
    rng = np.random.default_rng(2)
    t = np.sort(rng.random((t_end.size, 400)) * t_end.reshape(-1, 1), axis=1)
    lit = np.ones_like(t, bool)
    for begin, end in CASES[scene.name](scene, t_end):
        lit &= (t <= begin.reshape(-1, 1)) | (t >= end.reshape(-1, 1))
    seen, unsure = np.zeros_like(lit), np.zeros_like(lit)
    parts = (found.pixel, found.begin, found.end, found.begin_error, found.end_error)
    for pixel, begin, end, begin_error, end_error in zip(*parts, strict=True):
        row = t[pixel]
        seen[pixel] |= (row > begin) & (row < end)
        unsure[pixel] |= (np.abs(row - begin) <= begin_error) | (np.abs(row - end) <= end_error)
    return lit & ~seen & ~unsure, seen & ~lit & ~unsure


@pytest.mark.parametrize("name", CASES)
def test_shadows_of_a_closed_form(name: str) -> None:
    scene = load(name, size=(40, 40))
    missed, invented = missed_and_invented(scene, lit_intervals(scene))
    # of 640,000 places none is on the wrong side of an end by more than the end's own error
    assert not missed.any()
    assert not invented.any()


def test_ends_are_as_close_as_float32_allows() -> None:
    scene = load("sphere", size=(64, 64))
    found, exact = lit_intervals(scene), SphereScene(scene).lit()
    pixel = np.concatenate([np.flatnonzero(end > begin) for begin, end in exact])
    begin, end = (np.concatenate([piece[side][piece[1] > piece[0]] for piece in exact]) for side in (0, 1))
    order = np.lexsort([begin, pixel])
    assert found.pixel.tolist() == pixel[order].tolist()
    off = np.concatenate([np.abs(found.begin - begin[order]), np.abs(found.end - end[order])])
    error = np.concatenate([found.begin_error, found.end_error])
    # measured: 1.9e-6 at the 99th percentile, 5.7e-5 where a ray grazes the sphere's shadow; at most 0.66 of the error
    assert np.quantile(off, 0.99) < 5e-6
    assert off.max() < 2e-4
    assert (off <= error).all()


def test_order_and_offsets(tmp_path: Path) -> None:
    lights = point(0.3, 2.6, 0) + point(-2, 0.5, 1) + spot("0, 3, 0", "0, 0, 0", 20, 20)
    scene = write_scene(tmp_path, lights, sphere(0, 0, 0, 0.8), size=(9, 7))
    found = lit_intervals(scene)
    keys = list(zip(found.pixel.tolist(), found.light.tolist(), found.begin.tolist(), strict=True))
    assert keys == sorted(keys)
    assert (found.pixels, found.lights, found.offsets.size) == (63, 3, 190)
    for i in (0, 94, 95, 188):
        mine = slice(found.offsets[i], found.offsets[i + 1])
        assert (found.pixel[mine] == i // 3).all()
        assert (found.light[mine] == i % 3).all()
    assert np.diff(found.offsets).sum() == found.begin.size
    # those of one light are those that it has alone
    alone = lit_intervals(write_scene(tmp_path, point(-2, 0.5, 1), sphere(0, 0, 0, 0.8), size=(9, 7)))
    assert found.begin[found.light == 1].tolist() == alone.begin.tolist()
    assert found.end[found.light == 1].tolist() == alone.end.tolist()


def test_a_spot_reaches_its_cone(tmp_path: Path) -> None:
    scene = write_scene(tmp_path, spot("0.3, 3.5, 0", "0, 0, 0", 24, 6), size=(24, 24))
    (light,) = scene.lights
    begin, end = cone_interval(scene, light.position, light.direction, light.cutoff_angle, scene.camera.rays()[2])
    found = lit_intervals(scene)
    hit = (end > begin).ravel()
    assert found.pixel.tolist() == np.flatnonzero(hit).tolist()
    # measured: 4e-15
    np.testing.assert_allclose(found.begin, begin.ravel()[hit], rtol=1e-11)
    np.testing.assert_allclose(found.end, end.ravel()[hit], rtol=1e-11)


def test_parallel_light_reaches_the_fog(tmp_path: Path) -> None:
    scene = slab_scene(tmp_path, VIEWS["from above"])
    origin, direction, _ = scene.camera.rays()
    found = lit_intervals(scene)
    for place, height in ((found.begin, TOP), (found.end, BOTTOM)):
        exact = (height - origin[..., 1]) / direction[..., 1]
        np.testing.assert_allclose(place, exact.ravel(), rtol=1e-6)


def test_a_boundary_around_everything_changes_nothing(tmp_path: Path) -> None:
    box = (
        "<shape type='cube'><bsdf type='null'/><ref name='interior' id='fog'/>"
        "<transform name='to_world'><scale value='40'/></transform></shape>"
    )
    free, held = (
        lit_intervals(write_scene(tmp_path, shapes=sphere(0, 0, 0, 1) + more, size=(32, 32))) for more in ("", box)
    )
    assert held.pixel.tolist() == free.pixel.tolist()
    for side in ("begin", "end"):
        off = np.abs(getattr(held, side) - getattr(free, side))
        assert (off <= getattr(held, f"{side}_error") + getattr(free, f"{side}_error")).all()


def test_a_sliver_is_found_beside_longer_ones() -> None:
    scene = load("light_behind_eye", size=(96, 96))
    # of dark pieces shorter than the first spacing, those that neighbours with another count of changes give away
    coarse, fine = searched(scene, steps=(512,)), searched(scene)
    more = np.bincount(fine.intervals.pixel, minlength=96**2) - np.bincount(coarse.intervals.pixel, minlength=96**2)
    # measured: 7, which are 5e-4 to 5.6e-3 long
    assert 3 <= (more > 0).sum() <= 30
    assert not fine.open.any()


def test_too_few_probes_leave_rays_open() -> None:
    scene = load("slit", size=(48, 48))
    few = searched(scene, steps=(4,))
    assert few.open.any()
    # there the ray has more with as many probes than with half of them, elsewhere the same
    now, before = (np.bincount(of.pixel, minlength=48**2) for of in (few.intervals, few.before))
    assert (now[few.open] != before[few.open]).any()
    assert (now[~few.open] == before[~few.open]).all()
    assert not searched(scene).open.any()


@pytest.mark.parametrize("wavefront", [1, 5000])
def test_tiles_are_one_whole(wavefront: int, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = load("sphere", size=(6, 6))
    whole = searched(scene, steps=(64, 512)).intervals
    monkeypatch.setattr(probes, "WAVEFRONT", wavefront)
    tiled = searched(scene, steps=(64, 512)).intervals
    assert tiled.pixel.tolist() == whole.pixel.tolist()
    np.testing.assert_array_equal(tiled.begin, whole.begin)
    np.testing.assert_array_equal(tiled.end, whole.end)
