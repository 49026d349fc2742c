"""Ends of lit intervals against closed forms where float32 has its worst: small, far and near occluders, long shadows.

Each end must be within the error that it states, and that must be small.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from known_answers import CASES, Ball, Case, point
from lit_pieces import lit_pieces, rays_of

from reference.deterministic import lit_intervals
from scenes.loader import load


def ball_seen_from_beside(distance: float, radius: float, x: float = 0.0) -> Case:
    """Ball at a distance from its lamp, and a view across its shadow; all of it at about x."""
    lamp, axis = np.array([x + 0.1, 2 + 0.9 * distance, 1]), np.array([0.05, -0.95, -0.3]) / np.sqrt(0.995)
    centre, target = lamp + distance * axis, lamp + (distance + 1.5) * axis
    return Case(
        "",
        point(*lamp),
        (Ball(tuple(map(float, centre)), radius),),
        eye=f"{x}, {target[1]}, 6",
        target=", ".join(map(str, target)),
        fov=40,
    )


# with the largest error that an end may state at the 90th percentile; measured: 0.54 of that or less
ENDS = {
    "light behind the eye": (CASES["light_behind_the_eye"], 2e-4),
    "half-plane": (CASES["half_plane"], 2e-4),
    "slit": (CASES["slit"], 1.5e-4),
    # a discriminant in float32 shifts its edge by up to 1.5e-5; as it is found now it is off by 2.0e-7 at most
    "small ball": (ball_seen_from_beside(3, 0.05), 1e-5),
    "ball far from its lamp": (ball_seen_from_beside(9, 0.2), 1e-5),
    "ball close to its lamp": (ball_seen_from_beside(0.3, 0.02), 4e-5),
    "far from the origin": (ball_seen_from_beside(3, 0.2, x=50), 6e-5),
}


def ends(case: Case, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """By how much the ends of all intervals inside the rays are off, and what they say, (n,) each [scene unit]."""
    scene = load(case.write(folder / "scene.xml", "isotropic"), size=(96, 72))
    found, (light,) = lit_intervals(scene), scene.lights
    off, error = [], []
    for pixel, ray in enumerate(rays_of(scene.camera, case.occluders)):
        mine = slice(found.offsets[pixel], found.offsets[pixel + 1])
        exact = np.array(lit_pieces(ray, light, case.occluders, (0.0, ray.end))).reshape(-1, 2)
        # pieces that touch are one
        touch = exact[1:, 0] == exact[:-1, 1]
        exact = [exact[np.append(True, ~touch)[: len(exact)], 0], exact[np.append(~touch, True)[: len(exact)], 1]]
        if found.begin[mine].size != exact[0].size:
            # a ray that grazes the shadow, by less than float32 tells; few do, see the caller
            continue
        for side, t, said in zip(
            exact, (found.begin[mine], found.end[mine]), (found.begin_error[mine], found.end_error[mine]), strict=True
        ):
            inside = (side > 0) & (side < ray.end)
            off += list(np.abs(t - side)[inside])
            error += list(said[inside])
    return np.array(off), np.array(error)


@pytest.mark.parametrize(("case", "largest_error"), ENDS.values(), ids=ENDS)
def test_ends_are_off_by_no_more_than_they_say(case: Case, largest_error: float, tmp_path: Path) -> None:
    off, error = ends(case, tmp_path)
    assert off.size > 200
    # measured: at most 0.58
    assert (off <= error).all(), (off / error).max()
    assert np.quantile(error, 0.9) < largest_error
