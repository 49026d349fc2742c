"""Visibility, surface and depth against the exact shadow of a sphere (oracles.SphereScene), on llvmpipe."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from oracles import SphereScene

from scenes.loader import load

QUADRATURE = "lit_intervals:unbounded+quadrature"
BOUNDED = "lit_intervals+quadrature"
# samples and texels, each twice as fine as the one before
REFINED = (64, 256), (128, 512), (256, 1024)


@pytest.fixture(scope="module")
def exact() -> SphereScene:
    return SphereScene(load("sphere", size=(64, 64)))


def relative(image: np.ndarray, exact: np.ndarray) -> np.ndarray:
    return np.abs(image - exact) / exact


def test_the_oracle_agrees_with_itself(exact: SphereScene) -> None:
    """Lit pieces and both shadows together are the whole ray, and points in them are what a shadow ray says."""
    light, centre = exact.scene.lights[0].position, np.array([0.0, 1.6, 0.0])
    origin, direction, _ = exact.scene.camera.rays()
    rng = np.random.default_rng(1)
    t = rng.uniform(0.001, 0.999, exact.t_end.shape) * np.minimum(exact.t_end, 12)
    point = origin + t[..., None] * direction
    to_point = point - light
    closest = np.clip(((centre - light) * to_point).sum(-1) / (to_point**2).sum(-1), 0, 1)
    blocked = np.linalg.norm(light + closest[..., None] * to_point - centre, axis=-1) < 0.6
    on_floor = light + to_point * (light[1] / np.where(to_point[..., 1] < 0, -to_point[..., 1], np.inf))[..., None]
    blocked |= (point[..., 1] < 0) & (np.abs(on_floor[..., [0, 2]]).max(-1) < 8)
    lit = np.any([(begin < t) & (t < end) for begin, end in exact.lit()], axis=0)
    assert (lit == ~blocked).all()
    assert blocked.sum() > 40


@pytest.mark.parametrize("parameters", [{}, {"phase": "hg", "g": 0.6, "sigma_t": 0.3}], ids=str)
def test_lit_intervals_converge_to_the_exact_shadow(parameters: dict, draw) -> None:
    scene = load("sphere", size=(64, 64), **parameters)
    truth = SphereScene(scene).scattering()
    errors = []
    for steps, shadow_map in REFINED:
        image = draw(scene, QUADRATURE, steps=steps, shadow_map=shadow_map).scattering
        error = relative(image, truth)
        # most rays meet no shadow; measured 2.2e-7 (isotropic), 4.4e-7 (hg)
        assert np.median(error) < 2e-6
        errors.append(np.percentile(error, 95))
        assert image.mean() == pytest.approx(truth.mean(), rel=3e-4)
    # measured 1.2e-2, 6.0e-3, 3.1e-3 (isotropic): first order, as the ends of an interval are off by up to half a step
    assert errors[-1] < 5e-3
    for coarse, fine in itertools.pairwise(errors):
        assert fine < 0.7 * coarse


def test_shadow_polygons_put_ends_where_they_are(exact: SphereScene, draw) -> None:
    """Where one shadow is all that a ray meets, its ends are the polygons' own, however few the samples."""
    truth = exact.scattering()
    errors = []
    for steps, shadow_map in REFINED:
        error = relative(draw(exact.scene, BOUNDED, steps=steps, shadow_map=shadow_map).scattering, truth)
        # the tessellated sphere's silhouette; measured 2.7e-5 to 3.5e-5, without polygons 1.2e-2 to 3.1e-3
        assert np.percentile(error, 95) < 1e-4
        errors.append(np.percentile(error, 99))
    # measured 4.0e-3, 2.2e-3, 1.1e-3: first order, where the end of a ray lies in the dark or near to it
    assert errors[-1] < 2e-3
    for coarse, fine in itertools.pairwise(errors):
        assert fine < 0.7 * coarse


def test_a_march_converges_to_the_exact_shadow(exact: SphereScene, draw) -> None:
    truth = exact.scattering()
    errors = [
        np.percentile(relative(draw(exact.scene, "Nishita1987", steps=n, shadow_map=1024).scattering, truth), 95)
        for n in (64, 256, 1024)
    ]
    # its steps fill the ray to the far plane, not the cone of a light
    assert errors[2] < 0.5 * errors[1] < 0.25 * errors[0]


def test_a_march_looks_at_the_middle_of_each_step(exact: SphereScene, draw) -> None:
    steps = 256
    t = (np.arange(steps)[:, None, None] + 0.5) / steps * exact.t_end
    expected = sum(((begin < t) & (t < end)).sum(0) for begin, end in exact.lit())
    counted = draw(exact.scene, "Nishita1987", steps=steps, shadow_map=2048).lit_intervals
    partly = expected < steps
    assert partly.sum() > 500
    # a midpoint within a texel of the shadow's edge may fall to either side: measured 2.9 %; looking two steps on, 72 %
    assert (counted != expected)[partly].mean() < 0.1


def test_lit_intervals_are_counted(exact: SphereScene, draw) -> None:
    expected = sum((end > begin).astype(int) for begin, end in exact.lit())
    assert set(np.unique(expected)) == {1, 2}
    counted = draw(exact.scene, QUADRATURE, steps=512, shadow_map=2048).lit_intervals
    # measured: 1 of 4,096 pixels, which the shadow only grazes
    assert (counted != expected).sum() <= 5


def test_depth(exact: SphereScene, draw) -> None:
    depth = draw(exact.scene, QUADRATURE, steps=1, shadow_map=8).depth
    error = relative(depth, exact.t_end)
    nothing = ~(exact.on_sphere | exact.on_floor)
    assert exact.on_sphere.sum() > 60
    assert exact.on_floor.sum() > 1500
    # float32; on the floor at grazing incidence the interpolated position decides: measured 1.3e-6
    assert error[nothing].max() < 1e-6
    assert error[exact.on_floor].max() < 1e-5
    # the chords of the tessellation lie up to 1e-4 of the radius inside; measured 4.3e-5
    assert error[exact.on_sphere].max() < 1e-4


@pytest.mark.parametrize("sigma_t", [0.1, 0.5])
def test_surface(sigma_t: float, draw) -> None:
    exact = SphereScene(load("sphere", size=(64, 64), sigma_t=sigma_t))
    truth = exact.surface()
    image = draw(exact.scene, QUADRATURE, steps=1, shadow_map=1024).surface
    lit = (truth > 0).all(-1)
    assert (exact.on_floor & ~lit).sum() > 10
    assert (exact.on_sphere & ~lit).sum() > 10
    # shadows fall where they should, but for the texel at their edge: measured 0 pixels
    assert ((image > 0).all(-1) != lit).sum() <= 3
    both = lit & (image > 0).all(-1)
    error = (np.abs(image - truth) / np.where(truth > 0, truth, 1)).max(-1)
    # measured 1.0e-5 on the floor at its far edge, 2.1e-6 at the 95th percentile
    assert error[both & exact.on_floor].max() < 4e-5
    # the sphere's normals are interpolated over its facets: measured 7.4e-3 at the terminator, where the cosine is
    # small, 1.8e-4 in the median and 1.9e-4 of the brightest pixel
    assert np.median(error[both & exact.on_sphere]) < 6e-4
    assert np.abs(image - truth)[both & exact.on_sphere].max() < 6e-4 * truth[exact.on_sphere].max()
