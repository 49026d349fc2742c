"""What lit pieces of a ray send to the eye, by mpmath.

In fog that fills space, beside a light of one intensity, it is the oracle with its proven bound. A spot's soft edge and
fog that a box holds go by a quadrature of their own, cut at every kink of the integrand.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from lit_pieces import Box, Ray, crossings_of_cone
from mpmath import mp, mpf

from analytic.oracle import exact_airlight
from analytic.phase import Phase
from scenes.model import Light

DIGITS = 9
NODES = np.polynomial.legendre.leggauss(200)


@dataclass(frozen=True)
class Fog:
    """The medium.

    Attributes
    ----------
    sigma_s, sigma_t : (3,)          [1 / scene unit]
    phase : Phase                    for the oracle
    exact : function of the cosine   the same phase function in mpmath [1/sr]
    box : Box or None                what holds the fog
    light_share : float              share of the way to a light over which its light is attenuated; 1 but for `volpath`
    """

    sigma_s: np.ndarray
    sigma_t: np.ndarray
    phase: Phase
    exact: Callable[[Any], Any]
    box: Box | None
    light_share: float = 1.0


def airlight(fog: Fog, light: Light, ray: Ray, pieces: Sequence[tuple[float, float]], fog_begin: float) -> np.ndarray:
    """Airlight of lit pieces, (3,); fog attenuates it on the ray from `fog_begin` on."""
    plain = fog.box is None and light.beam_width == light.cutoff_angle
    one_piece = _by_oracle if plain else _by_quadrature
    channels = {
        sigma_t: sum((one_piece(fog, light, ray, begin, end, fog_begin, sigma_t) for begin, end in pieces), start=0.0)
        for sigma_t in set(fog.sigma_t)
    }
    return light.intensity * fog.sigma_s * [channels[sigma_t] for sigma_t in fog.sigma_t]


def _by_oracle(fog: Fog, light: Light, ray: Ray, begin: float, end: float, fog_begin: float, sigma_t: float) -> float:
    h, t_h = _beside(light, ray)
    value = _oracle(h, begin - t_h, end - t_h, sigma_t, fog.phase)
    with mp.workdps(DIGITS + 6):
        whole = float(value * mp.exp(-mpf(sigma_t) * (begin - fog_begin)))
    return whole * _brighter(fog, h, begin - t_h, end - t_h, sigma_t)


@cache
def _oracle(h: float, x_a: float, x_b: float, sigma_t: float, phase: Phase) -> Any:
    return exact_airlight(h, x_a, x_b, sigma_t, phase, DIGITS).value


def _brighter(fog: Fog, h: float, x_a: float, x_b: float, sigma_t: float) -> float:
    """By what factor a light's way that is attenuated over `light_share` of it brightens a piece.

    The mean of e^{(1 - light_share) sigma_t d} over the piece, weighted by what each of its points sends. It differs
    from 1 by some 1e-3 at most, and Gauss-Legendre over s, x = h sinh s, need only get that difference right.
    """
    if fog.light_share == 1:
        return 1.0
    h = max(h, 1e-9 * max(abs(x_a), abs(x_b)))
    first, last = np.arcsinh(x_a / h), np.arcsinh(x_b / h)
    nodes, weights = NODES
    s = first + (last - first) * (1 + nodes) / 2
    x, d = h * np.sinh(s), h * np.cosh(s)
    depth = sigma_t * (x + d)
    power = weights * np.exp(depth.min() - depth) * fog.phase.evaluate(-x / d) / d
    return float(power @ np.exp((1 - fog.light_share) * sigma_t * d) / power.sum())


def _by_quadrature(
    fog: Fog, light: Light, ray: Ray, begin: float, end: float, fog_begin: float, sigma_t: float
) -> float:
    parallel = light.kind == "directional"
    h, t_h = _beside(light, ray)
    away = ray.origin - light.position
    height, rise = float(away @ light.direction), float(ray.direction @ light.direction)
    soft = light.cutoff_angle - light.beam_width

    def integrand(t: Any) -> Any:
        x = t - t_h
        d = mp.sqrt(h * h + x * x)
        cosine = -rise if parallel else -x / d
        leg = d * fog.light_share
        if fog.box:
            # from the top on; the point's depth below it against the light's height above the point
            below = fog.box.half[1] - (ray.origin[1] + t * ray.direction[1])
            leg = below / -light.direction[1] if parallel else d * below / (below + light.position[1] - fog.box.half[1])
        falloff = mpf(1)
        if soft > 0:
            falloff = (light.cutoff_angle - mp.acos((height + t * rise) / d)) / soft
            falloff = min(max(falloff, mpf(0)), mpf(1))
        shed = falloff if parallel else falloff / (h * h + x * x)
        return shed * fog.exact(cosine) * mp.exp(-sigma_t * (t - fog_begin + leg))

    breaks = {begin, end}
    if not parallel:
        breaks |= {t_h, *(t_h - h * c / np.sqrt(1 - c * c) for c in map(float, getattr(fog.exact, "nodes", ())))}
        if soft > 0:
            breaks |= set(crossings_of_cone(ray, light.position, light.direction, float(np.cos(light.beam_width))))
    with mp.workdps(15):
        value, error = mp.quad(integrand, sorted(t for t in breaks if begin <= t <= end), error=True)
        assert error < mpf(10) ** -DIGITS * value
    return float(value)


def _beside(light: Light, ray: Ray) -> tuple[float, float]:
    """How far the light is from the ray's line, and where along it [scene unit]."""
    to_light = light.position - ray.origin
    return float(np.linalg.norm(np.cross(to_light, ray.direction))), float(to_light @ ray.direction)
