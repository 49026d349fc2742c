"""Every estimator on the table of known answers (tests/support/known_answers.py), under every phase function.

An estimate may be off by what its own error bar allows, in each pixel and in the mean over them, by Student's t with
Sidak's correction for as many values as the whole table has; and the error bar itself must be small, or the agreement
would say nothing. `volpath`, whose error bars are the widest, is also held to the table as a whole, where a bias of its
own would add up.

How well the mean over a case's pixels is known, relative, as measured (the estimate's own standard error):

- equiangular: 5.1e-4 or better in each row (ball_before_the_light);
- volpath: 2 % or better in each row (spot_across, spot_grazing), 0.4 % in half of them; 5.5e-4 over the whole table;
- film volpath: 2.6 % or better (spot_grazing); 2.4e-3 over the whole table;
- deterministic: within its own numerical error, of at most 2e-4 of a pixel.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import film_worker
import numpy as np
import pytest
from known_answers import CASES, PHASES, SIDES, grey, truth
from scipy import stats

from reference.convergence import Estimate, converge
from reference.deterministic import Deterministic
from reference.estimators import Equiangular, Volpath
from reference.goal import FEWEST_PASSES, Goal
from reference.integrator import mi
from scenes.errors import InputError
from scenes.loader import load
from scenes.model import Scene

GOAL = Goal(rel_error=0.002)
# as many passes as an error bar takes, whatever it is then
FEWEST = Goal(rel_error=0.999)
# how short of the light `volpath` stops; see reference/agreement.py
SHORT_OF_THE_LIGHT = 1 - mi.math.ShadowEpsilon
# that a right estimate fails anywhere in the table
CHANCE = 1e-3
VOLPATH_SAMPLES = 512
# relative, of what the table itself says: twice the oracle's digits
ORACLE = 2e-9
# of a film's pixels, which are not quite one point: measured, their mean is off by 4.5e-5 (spot_grazing), by 2e-6 or
# less elsewhere
FILM_ROUNDING = 1e-4
ROWS = [(name, phase_name) for name in CASES for phase_name in PHASES]
VOLPATH_ROWS = [row for row in ROWS if not CASES[row[0]].no_volpath]
# all rows would take eight times as long: each case under one phase function, each of these in turn
FILM_ROWS = [
    (name, list(PHASES)[number % len(PHASES)])
    for number, name in enumerate(dict.fromkeys(name for name, _ in VOLPATH_ROWS))
]


@dataclass(frozen=True)
class Found:
    """An estimate of one row: of its pixels and of their mean, (n, 3) and (3,), from `passes` independent ones."""

    mean: np.ndarray
    error: np.ndarray
    image_mean: np.ndarray
    image_error: np.ndarray
    passes: int

    @classmethod
    def of(cls, estimate: Estimate, layer: str) -> Found:
        """What an estimate says of one layer."""
        pixels, errors = (part[layer].reshape(-1, 3) for part in (estimate.mean, estimate.standard_error))
        return cls(pixels, errors, estimate.image_mean[layer], estimate.image_error[layer], estimate.passes)


class VolpathAtOnce(Volpath):
    """All passes in one wavefront, as the rows of one tall picture: else their overhead would be nine tenths."""

    def __init__(self, scene: Scene, samples: int, seed: int) -> None:
        super().__init__(scene, samples)
        self._picture = height, width = self.shape
        self.samples = np.full((FEWEST_PASSES * height, width), samples, np.uint32)
        self.shape = self.samples.shape
        self._passes = super().one_pass(seed)["composite"].reshape(FEWEST_PASSES, height, width, 3)
        self.samples = self.samples[:height]

    def rays(self, pixel, place=(0.5, 0.5)):
        """Rays of the picture, again and again."""
        tall, self.shape = self.shape, self._picture
        rays = super().rays(pixel % (self.shape[0] * self.shape[1]), place)
        self.shape = tall
        return rays

    def one_pass(self, seed: int) -> dict[str, np.ndarray]:
        """One of the passes."""
        return {"composite": self._passes[seed]}


def load_row(name: str, phase_name: str) -> Scene:
    with tempfile.TemporaryDirectory() as folder:
        return load(CASES[name].write(Path(folder) / "scene.xml", phase_name), size=SIDES)


@cache
def exact(name: str, phase_name: str, light_share: float = 1.0) -> np.ndarray:
    return truth(CASES[name], load_row(name, phase_name), phase_name, light_share).reshape(-1, 3)


@cache
def by_equiangular(name: str, phase_name: str) -> Found:
    return Found.of(converge(Equiangular(load_row(name, phase_name)), GOAL), "scattering")


@cache
def by_volpath(name: str, phase_name: str) -> Found:
    seed = ROWS.index((name, phase_name))
    return Found.of(converge(VolpathAtOnce(load_row(name, phase_name), VOLPATH_SAMPLES, seed), FEWEST), "composite")


@cache
def by_deterministic(name: str, phase_name: str) -> Found:
    return Found.of(Deterministic(load_row(name, phase_name)).estimate(), "scattering")


@cache
def films() -> dict[tuple[str, str], Found]:
    """The film's rows, all in one other process."""
    with tempfile.TemporaryDirectory() as folder:
        files = {row: Path(folder) / f"{'+'.join(row)}.xml" for row in FILM_ROWS}
        for (name, phase_name), path in files.items():
            CASES[name].write(path, phase_name, film_fov(name))
        run = subprocess.run(
            [sys.executable, film_worker.__file__, folder],
            env=os.environ | {"AIRLIGHT_MITSUBA_VARIANT": "scalar_rgb", "PYTHONPATH": str(Path(__file__).parents[2])},
            capture_output=True,
            text=True,
            check=False,
        )
        assert run.returncode == 0, run.stderr
        return {row: one_pixel(np.load(path.with_suffix(".npy"))[0]) for row, path in files.items()}


def film_fov(name: str) -> float:
    """So narrow that the film's mean airlight is that of its middle; see FILM_ROUNDING [degree]."""
    return 0.02 * min(1.0, CASES[name].fov)


def one_pixel(passes: np.ndarray) -> Found:
    """Every pixel of every pass as an estimate of one and the same value."""
    assert not passes.any() or len(np.unique(passes.mean(axis=(1, 2, 3)))) == len(passes)
    values = passes.reshape(-1, 3)
    mean, error = values.mean(axis=0), values.std(axis=0, ddof=1) / np.sqrt(len(values))
    return Found(mean[None], error[None], mean, error, len(values))


def worst_z(found: Found, truth: np.ndarray, rounding: float) -> tuple[float, float]:
    """Largest |z| of the lit pixels and of their mean."""
    lit = truth > 0
    pixels = (found.mean - truth)[lit] / np.hypot(found.error, rounding * truth)[lit]
    mean = truth.mean(axis=0)
    image = (found.image_mean - mean) / np.hypot(found.image_error, rounding * mean)
    return float(np.abs(pixels).max()), float(np.abs(image).max())


def check(found: Found, truth: np.ndarray, rounding: float, largest_error: float) -> None:
    """Fail where an estimate is off by more than it says, or where what it says would hide a mistake.

    Parameters
    ----------
    truth : (n, 3)
    rounding : float         of float32, relative; added in quadrature
    largest_error : float    of the mean over the pixels, relative
    """
    assert (found.mean[truth == 0] == 0).all()
    if not truth.any():
        return
    assert (found.image_error / truth.mean(axis=0)).max() < largest_error
    values = truth.size + 3
    limit = stats.t(found.passes - 1).isf(CHANCE / (len(ROWS) * 4 * values) / 2)
    assert max(worst_z(found, truth, rounding)) < limit


def check_numerical(found: Found, truth: np.ndarray) -> None:
    """Fail where a value without noise is off by more than it says, or where that is more than 2e-4."""
    assert (np.abs(found.mean - truth) <= found.error + ORACLE * truth).all()
    assert (found.error <= 2e-4 * truth).all()


def check_together(deviations: list[tuple[float, float]], largest_error: float) -> None:
    """Fail where relative deviations, each with its standard error, do not average out to 0."""
    values, errors = np.transpose(deviations)
    error = np.sqrt(np.sum(errors**2)) / len(errors)
    assert error < largest_error
    assert abs(values.mean()) < 4 * error


def deviation(found: Found, truth: np.ndarray) -> tuple[float, float]:
    """Of the mean over pixels and channels, relative, and its standard error: channels share their paths."""
    mean = float(truth.mean())
    return float(found.image_mean.mean()) / mean - 1, float(found.image_error.mean()) / mean


def film_truth(name: str, phase_name: str) -> np.ndarray:
    with tempfile.TemporaryDirectory() as folder:
        scene = load(CASES[name].write(Path(folder) / "scene.xml", phase_name, film_fov(name)), size=(1, 1))
    return truth(CASES[name], scene, phase_name, SHORT_OF_THE_LIGHT).reshape(1, 3)


every_row = pytest.mark.parametrize(("name", "phase_name"), ROWS, ids=map("-".join, ROWS))
volpath_row = pytest.mark.parametrize(("name", "phase_name"), VOLPATH_ROWS, ids=map("-".join, VOLPATH_ROWS))
film_row = pytest.mark.parametrize(("name", "phase_name"), FILM_ROWS, ids=map("-".join, FILM_ROWS))


@every_row
def test_equiangular(name: str, phase_name: str) -> None:
    found = by_equiangular(name, phase_name)
    check(found, exact(name, phase_name), CASES[name].rounding, largest_error=2e-3)


@every_row
def test_deterministic(name: str, phase_name: str) -> None:
    check_numerical(by_deterministic(name, phase_name), exact(name, phase_name))


@volpath_row
def test_volpath(name: str, phase_name: str) -> None:
    check(by_volpath(name, phase_name), exact(name, phase_name, SHORT_OF_THE_LIGHT), 0.0, largest_error=0.025)


@film_row
def test_film_volpath(name: str, phase_name: str) -> None:
    check(films()[name, phase_name], film_truth(name, phase_name), FILM_ROUNDING, largest_error=0.04)


def test_volpath_over_the_whole_table() -> None:
    found = [deviation(by_volpath(*row), exact(*row, SHORT_OF_THE_LIGHT)) for row in VOLPATH_ROWS]
    # measured: 5.5e-4
    check_together(found, largest_error=8e-4)
    with pytest.raises(AssertionError):
        check_together([(value + 0.005, error) for value, error in found], largest_error=8e-4)


def test_film_volpath_over_its_table() -> None:
    lit = [row for row in FILM_ROWS if film_truth(*row).any()]
    found = [deviation(films()[row], film_truth(*row)) for row in lit]
    # measured: 2.4e-3
    check_together(found, largest_error=3.5e-3)
    with pytest.raises(AssertionError):
        check_together([(value + 0.02, error) for value, error in found], largest_error=3.5e-3)


@pytest.mark.parametrize("estimate", [by_equiangular, by_deterministic])
@pytest.mark.parametrize("wrong", [0.99, 1.01])
def test_a_wrong_value_fails(estimate: Callable[[str, str], Found], wrong: float) -> None:
    found, truth = estimate("sphere_on_the_axis", "hg0.6"), wrong * exact("sphere_on_the_axis", "hg0.6")
    with pytest.raises(AssertionError):
        check_numerical(found, truth) if estimate is by_deterministic else check(found, truth, 2e-6, 2e-3)


ESTIMATES: dict[str, Callable[[Scene], Estimate]] = {
    "equiangular": lambda scene: converge(Equiangular(scene), FEWEST),
    "volpath": lambda scene: converge(Volpath(scene), FEWEST),
    "deterministic": lambda scene: Deterministic(scene).estimate(),
}
BEYOND_FLOAT32 = replace(CASES["thick_100"], sigma_t=grey(100))


@pytest.mark.parametrize("estimate", ESTIMATES.values(), ids=ESTIMATES)
def test_zero_albedo_is_refused(estimate: Callable[[Scene], Estimate], tmp_path: Path) -> None:
    case = replace(CASES["no_occluder"], albedo=0.0)
    with pytest.raises(InputError, match="zero everywhere"):
        estimate(load(case.write(tmp_path / "scene.xml", "isotropic"), size=SIDES))


def test_a_depth_beyond_float32_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="zero everywhere"):
        converge(Equiangular(load(BEYOND_FLOAT32.write(tmp_path / "scene.xml", "isotropic"), size=SIDES)), FEWEST)


def test_fog_that_scatters_nothing_before_a_wall(tmp_path: Path) -> None:
    """The wall alone, z = 0, of reflectance 0.5: both legs attenuated."""
    wall = "<shape type='rectangle'><transform name='to_world'><scale value='9'/></transform></shape>"
    case = replace(CASES["no_occluder"], albedo=0.0, lights=CASES["no_occluder"].lights + wall)
    scene = load(case.write(tmp_path / "scene.xml", "isotropic"), size=SIDES)
    origin, direction, _ = scene.camera.rays()
    t = -origin[..., 2] / direction[..., 2]
    to_light = scene.lights[0].position - (origin + t[..., None] * direction)
    d = np.linalg.norm(to_light, axis=-1)
    wall_alone = (10 * 0.5 / np.pi * to_light[..., 2] / d**3 * np.exp(-0.2 * (t + d)))[..., None].repeat(3, axis=-1)
    # float32: measured 3e-7
    np.testing.assert_allclose(Equiangular(scene).fixed()["surface"], wall_alone, rtol=2e-6)
    # `volpath` meets the wall with the probability of the transmittance, e^-1
    found = Found.of(converge(VolpathAtOnce(scene, 1024, seed=0), FEWEST), "composite")
    shorter = wall_alone * np.exp(0.2 * d * mi.math.ShadowEpsilon)[..., None]
    check(found, shorter.reshape(-1, 3), 0.0, largest_error=0.01)
