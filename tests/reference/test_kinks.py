"""Stretches cut where the scattered light has kinks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from slab import VIEWS, slab_scene

from reference.deterministic.kinks import Stretches, cut, cut_at_kinks, cut_by_depth
from reference.deterministic.ray_spans import Rays, chord
from scenes.loader import load


def test_cut_keeps_what_lies_outside_out_and_leaves_no_gap() -> None:
    whole = Stretches(np.array([3, 5]), np.array([0.0, 1.0]), np.array([2.0, 4.0]))
    parts = cut(whole, np.array([1, 0, 1, 1, 0]), np.array([2.0, 0.5, 9.0, 1.0, np.nan]))
    assert parts.ray.tolist() == [3, 3, 5, 5]
    assert parts.begin.tolist() == [0.0, 0.5, 1.0, 2.0]
    assert parts.end.tolist() == [0.5, 2.0, 2.0, 4.0]


def test_thick_stretches_are_cut_towards_both_ends() -> None:
    parts = cut_by_depth(Stretches(np.arange(2), np.zeros(2), np.array([0.1, 8.0])), sigma_t=1.0)
    assert parts.begin.tolist() == [0.0, 0.0, 1.0, 2.0, 4.0, 6.0, 7.0]
    assert parts.ray.tolist() == [0, 1, 1, 1, 1, 1, 1]


@pytest.mark.parametrize("name", ["lamp_outside", "sun_in_a_box"])
def test_between_cuts_the_light_comes_through_one_face(name: str, others: Path) -> None:
    scene = load(others / f"{name}.xml", size=(16, 12))
    assert scene.boundary is not None
    (light, *_) = scene.lights
    # beyond a corner, from where the light comes through three faces
    light = replace(light, position=1.5 * scene.boundary.corners.max(axis=0))
    rays = Rays.of_camera(scene, scene.camera.rays()[2].ravel())
    inside = np.flatnonzero(rays.fog_end > rays.fog_begin)
    whole = Stretches(inside, rays.fog_begin[inside], rays.fog_end[inside])
    parts = cut_at_kinks(whole, rays, scene, light)
    assert parts.ray.size > whole.ray.size

    def face(share: float) -> np.ndarray:
        t = parts.begin + share * (parts.end - parts.begin)
        point = rays.origin[parts.ray] + t[:, None] * rays.direction[parts.ray]
        way = -light.direction if light.kind == "directional" else light.position - point
        way = np.broadcast_to(way, point.shape)
        way = way / np.linalg.norm(way, axis=-1, keepdims=True)
        out = point + chord(scene.boundary, point, way)[1][:, None] * way
        return np.abs(out @ scene.boundary.planes[:, :3].T - scene.boundary.planes[:, 3]).argmin(axis=1)

    long = parts.end - parts.begin > 1e-6
    assert (face(0.001)[long] == face(0.999)[long]).all()
    # and each cut is one: the face changes there
    within = (parts.ray[1:] == parts.ray[:-1]) & long[1:] & long[:-1]
    assert (face(0.999)[:-1][within] != face(0.001)[1:][within]).all()


def test_a_slab_has_one_face_that_counts(tmp_path: Path) -> None:
    scene = slab_scene(tmp_path, VIEWS["from above"])
    rays = Rays.of_camera(scene, scene.camera.rays()[2].ravel())
    whole = Stretches(np.arange(len(rays)), rays.fog_begin, rays.fog_end)
    assert cut_at_kinks(whole, rays, scene, scene.lights[0]).ray.size == len(rays)
