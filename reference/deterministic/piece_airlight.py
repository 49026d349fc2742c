"""Airlight of lit pieces of rays in float64: in closed form where there is one, by adaptive quadrature elsewhere."""

from __future__ import annotations

import numpy as np

import analytic
from reference.deterministic.adaptive_quadrature import integrate
from reference.deterministic.equiangular_variable import angle_between, place_at
from reference.deterministic.kinks import Stretches, cut_at_beam, cut_at_kinks, cut_by_depth
from reference.deterministic.ray_spans import Array, Rays
from reference.deterministic.scattered_light import ScatteredLight
from scenes.model import Light, Scene

# of the analytic package's quadrature, and of sums in float64, relative
ROUNDING = 1e-12


def piece_airlight(
    scene: Scene, light: Light, scattered: ScatteredLight, rays: Rays, pieces: Stretches
) -> tuple[Array, Array]:
    """Airlight of one light, summed over the pieces of each ray.

    The `quadrature` of `analytic` takes what a point light shines on with one intensity through fog alone; the rest,
    the soft rim and the picture of a spot, parallel light and light from outside the fog, is integrated over the angle
    at which the light sees it, in pieces without kinks.

    Parameters
    ----------
    scattered : ScatteredLight    of that light
    rays : Rays                   of all pixels
    pieces : Stretches            lit by the light

    Returns
    -------
    value, error : (rays, 3)    radiance; the error is numerical, and far larger than what is off
    """
    pieces = cut_at_beam(pieces, rays, light)
    uniform = scattered.uniform(rays[pieces.ray], 0.5 * (pieces.begin + pieces.end))
    value = _analytic(scene, light, rays, pieces[uniform])
    rest = cut_by_depth(cut_at_kinks(pieces[~uniform], rays, scene, light), float(np.max(scene.medium.sigma_t)))
    more, error = _integrated(light, scattered, rays, rest)
    value = value + more
    return value, error + ROUNDING * value


def _analytic(scene: Scene, light: Light, rays: Rays, pieces: Stretches) -> Array:
    h, t_h = (part[pieces.ray] for part in rays.beside(light))
    airlight = analytic.airlight(h, pieces.begin - t_h, pieces.end - t_h, scene.medium, scene.phase)
    airlight = airlight if scene.medium.sigma_t.ndim else airlight[:, None]
    way = (pieces.begin - rays.fog_begin[pieces.ray])[:, None]
    seen = airlight * np.exp(-scene.medium.sigma_t * way) * light.intensity
    return np.stack([np.bincount(pieces.ray, seen[:, channel], len(rays)) for channel in range(3)], axis=-1)


def _integrated(light: Light, scattered: ScatteredLight, rays: Rays, pieces: Stretches) -> tuple[Array, Array]:
    h, t_h = (part[pieces.ray] for part in rays.beside(light))
    s_a = pieces.begin - t_h
    angle, h = angle_between(h, s_a, pieces.end - t_h)

    def along(number: np.ndarray, share: Array) -> Array:
        """Density in the share of the angle, or of the length for parallel light."""
        begin, end = pieces.begin[number, None], pieces.end[number, None]
        if light.kind == "directional":
            t, stretch = begin + share * (end - begin), end - begin
        else:
            height, width = h[number, None], angle[number, None]
            s = place_at(np.tan(share * width), height, s_a[number, None])
            t = np.clip(t_h[number, None] + s, begin, end)
            stretch = width * (height * height + s * s) / height
        return scattered.density(rays[pieces.ray[number]], t) * stretch[..., None]

    return integrate(along, pieces.ray, len(rays))
