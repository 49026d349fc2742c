"""Where along a ray light is scattered: bounds and densities from which the integrator samples distances."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from scenes.mitsuba_setup import mitsuba

mi = mitsuba()
import drjit as dr  # noqa: E402

# Optical depth of the light from the ray's beginning from which the fog is thick. On `sphere` with 16 strata a pixel's
# median spread is 0.007 / 0.018 / 0.042 / 0.072 / 0.15 / 0.37 at depths 0.6 / 6 / 13 / 19 / 32 / 64 by the equiangular
# density alone, and 0.018 / 0.018 / 0.021 / 0.024 / 0.028 / 0.034 where half of the samples come from the other one.
THICK = 6.0


def position_of(emitter: Any, ray: Any) -> Any:
    """Where a point-like emitter is, Point3f."""
    anywhere = dr.zeros(mi.Interaction3f)
    anywhere.p = ray.o
    return emitter.sample_direction(anywhere, mi.Point2f(0.5), True)[0].p


def reach(emitter: Any, ray: Any, t_max: Any) -> tuple[Any, Any]:
    """Bound the part of the ray that a light can reach: a spot's cone, or everything for a point light.

    It only says where to sample; the light's own falloff decides what is lit. So it is never narrower than the cone,
    and wider by no more than what float32 leaves open: a dark margin of a thousandth would be met by a sample in a
    thousand, and until then both the mean and its error bar would be wrong.

    Returns
    -------
    begin, end : Float    [scene unit]; begin = end where the light reaches nothing
    """
    begin, end = mi.Float64(0.0), mi.Float64(t_max)
    parameters = mi.traverse(emitter)
    cutoff = np.radians(float(np.max(parameters["cutoff_angle"]))) if "cutoff_angle" in parameters else np.pi
    # Mitsuba rounds the cosine of a direction to some 1e-7
    cutoff = cutoff + 3e-7 / np.sin(cutoff) if cutoff < np.pi else cutoff
    if cutoff > 0.49 * np.pi:
        return mi.Float(begin), mi.Float(end)
    axis = dr.normalize(mi.Vector3d(parameters["to_world"] @ mi.Vector3f(0, 0, 1)))
    cos2 = float(np.cos(cutoff)) ** 2
    d, from_light = mi.Vector3d(ray.d), mi.Point3d(ray.o) - mi.Point3d(position_of(emitter, ray))
    along_d, along_o = dr.dot(d, axis), dr.dot(from_light, axis)
    # the ray is inside the double cone where a t^2 + 2 b t + c > 0
    a = dr.square(along_d) - cos2 * dr.squared_norm(d)
    b = along_d * along_o - cos2 * dr.dot(d, from_light)
    c = dr.square(along_o) - cos2 * dr.squared_norm(from_light)
    a = dr.select(dr.abs(a) < 1e-12, 1e-12, a)
    root = dr.sqrt(dr.maximum(dr.square(b) - a * c, 0))
    low, high = dr.minimum((-b - root) / a, (-b + root) / a), dr.maximum((-b - root) / a, (-b + root) / a)
    # a > 0: the ray enters or leaves one nappe for good; a < 0: it crosses one, maybe the dark one behind the light
    crossing = a < 0
    begin = dr.select(crossing | (along_d > 0), dr.select(crossing, low, high), begin)
    end = dr.select(crossing, high, dr.select(along_d > 0, end, low))
    dark = crossing & ((dr.square(b) <= a * c) | (along_o + 0.5 * (low + high) * along_d < 0))
    begin = dr.clip(begin, 0, t_max)
    return mi.Float(begin), mi.Float(dr.select(dark, begin, dr.clip(end, begin, t_max)))


def equiangular_or_attenuated(
    ray: Any, begin: Any, end: Any, position: Any, sigma_t: Any
) -> Callable[[Any], tuple[Any, Any]]:
    """Sample a distance on [begin, end] in proportion to 1 / d^2, or to the transmittance of both legs.

    The first is Kulla and Fajardo 2012, section 4. In thick fog it would spend nearly all samples where nothing is left
    to see: the integrand's other factor is e^(-sigma_t w), w = t + d the whole way, in which it is sampled directly,
    dw / dt = w / d counted from the light's projection. There the two are drawn as one mixture, half and
    half; in thin fog the second has nothing to add.

    Returns
    -------
    sample : callable
        A number from 0 to 1, Float64, to a distance t, Float, and the inverse of its density, Float [scene unit].
    """
    # float64, and the difference of the two angles as one arc tangent: on a ray that points at the light or away from
    # it both are pi / 2 but for a millionth, and float32 would quantise their difference alike in every pass
    d, to_light = mi.Vector3d(ray.d), mi.Point3d(position) - mi.Point3d(ray.o)
    t_h = dr.dot(to_light, d)
    s_a, s_b = mi.Float64(begin) - t_h, mi.Float64(end) - t_h
    # a ray through the light keeps a distance that float64 resolves
    h = dr.maximum(dr.norm(dr.cross(to_light, d)), 1e-14 * dr.maximum(dr.abs(s_a), dr.abs(s_b)))
    h = dr.maximum(h, 1e-300)
    angle = dr.atan2((s_b - s_a) * h, dr.square(h) + s_a * s_b)

    def way(s: Any) -> Any:
        return dr.select(s > 0, s + dr.hypot(h, s), dr.square(h) / (dr.hypot(h, s) + dr.abs(s)))

    w_a = way(s_a)
    rate = mi.Float64(sigma_t)
    rate = dr.maximum(rate, 1e-300)
    depth = rate * (way(s_b) - w_a)
    lost = dr.maximum(1 - dr.exp(-depth), 1e-300)
    # a piece of next to no depth is one on which the two densities are the same but for lost digits
    share: Any = dr.select((rate * dr.hypot(h, s_a) > THICK) & (depth > 1e-3), 0.5, 0)

    def sample(u: Any) -> tuple[Any, Any]:
        attenuated = u < share
        tangent = dr.tan(angle * (u - share) / (1 - share))
        s = s_a + tangent * (dr.square(h) + dr.square(s_a)) / (h - s_a * tangent)
        w = w_a - dr.log(1 - lost * u / dr.maximum(share, 1e-300)) / rate
        s = dr.select(attenuated, 0.5 * (w - dr.square(h) / w), s)
        # the weight belongs to the distance that float32 keeps
        t = dr.clip(mi.Float(s + t_h), begin, end)
        s = mi.Float64(t) - t_h
        pdf = (1 - share) * h / (angle * (dr.square(h) + dr.square(s)))
        w = way(s)
        pdf += share * rate * dr.exp(-rate * (w - w_a)) / lost * w / dr.hypot(h, s)
        return t, mi.Float(dr.select(angle > 0, 1 / pdf, 0))

    return sample


def even_or_attenuated(begin: Any, end: Any, sigma_t: Any) -> Callable[[Any], tuple[Any, Any]]:
    """Sample a distance on [begin, end] evenly or by e^(-sigma_t t), each half the time, for parallel light.

    Where the light's own way grows shorter along the ray the integrand does not fall, so neither serves alone.

    Returns
    -------
    sample : callable    as that of `equiangular_or_attenuated`
    """
    length, rate = mi.Float64(end - begin), mi.Float64(sigma_t)
    # in fog so thin the two are one, and the differences from 1 below have lost their digits
    rate = dr.maximum(rate, 1e-6 / dr.maximum(length, 1e-300))
    lost = 1 - dr.exp(-rate * length)

    def sample(u: Any) -> tuple[Any, Any]:
        s = dr.select(u < 0.5, -dr.log(1 - 2 * u * lost) / rate, (2 * u - 1) * length)
        s = dr.clip(s, 0, length)
        pdf = 0.5 * rate * dr.exp(-rate * s) / lost + 0.5 / dr.maximum(length, 1e-300)
        return mi.Float(begin + s), mi.Float(dr.select(length > 0, 1 / pdf, 0))

    return sample


def shifted_strata(count: Any, shift: Any) -> Callable[[Any], tuple[Any, Any]]:
    """Cut 0 to 1 into strata that a random number shifts.

    Were the cuts at the same places in every pass, a shadow's edge close behind one would be met by few samples or by
    none, and the passes would agree on a wrong mean: z of up to 18 after 32 of them, over a table of known answers.
    All strata have one width but the first and the last, which share it.

    Parameters
    ----------
    count : UInt32
    shift : Float64    a number from 0 to 1

    Returns
    -------
    stratum : callable    number of a stratum, UInt32, to its begin and end, Float64
    """
    # float64: a thousand strata leave float32 too few places in each
    whole = mi.Float64(dr.maximum(count, 2) - 1)
    shift = dr.select(count > 1, shift, 0)

    def stratum(number: Any) -> tuple[Any, Any]:
        begin = (mi.Float64(number) - shift) / whole
        return dr.maximum(begin, 0), dr.minimum(begin + 1 / whole, 1)

    return stratum
