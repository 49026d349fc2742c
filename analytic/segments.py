"""Pieces of rays beside a point light, as every airlight model takes them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import DTypeLike, NDArray

__all__ = ["Segments", "h_times_v", "half_angle"]

# h enters as (h / (x r))^2, r the width of a phase function's peak: this much of |x| is nothing in float64 for any peak
# that a float64 parameter can have
NEGLIGIBLE = 1e-25


@dataclass(frozen=True, eq=False)
class Segments:
    """Flat arrays of one floating-point type; what a model computes from them is of that type too.

    Both the end and the length are given, because neither follows from the other without losing digits: the end matters
    where it is close to the light's projection, the length where the segment is short and far from it.

    Attributes
    ----------
    h : ndarray, (n,)        distance of the light from the ray, above 0 [scene unit]
    x_a : ndarray, (n,)      the eye, from the light's projection on the ray [scene unit]
    x_b : ndarray, (n,)      end of the segment, may be inf [scene unit]
    length : ndarray, (n,)   x_b - x_a, above 0 [scene unit]
    sigma_t : ndarray, (n,)  extinction coefficient [1 / scene unit]

    Source: Weng 2010, Figure 4.6; its u = (x - x_h) / h, H and v of section 4.3.
    """

    h: NDArray[np.floating]
    x_a: NDArray[np.floating]
    x_b: NDArray[np.floating]
    length: NDArray[np.floating]
    sigma_t: NDArray[np.floating]

    @classmethod
    def between(
        cls,
        h: NDArray[np.floating],
        x_a: NDArray[np.floating],
        x_b: NDArray[np.floating],
        sigma_t: NDArray[np.floating],
    ) -> Segments:
        """Segments given by both ends; in float64 the length is then right to the last digit."""
        return cls(h, x_a, x_b, x_b - x_a, sigma_t)

    def __getitem__(self, which: NDArray[np.bool_] | NDArray[np.intp] | slice) -> Segments:
        return Segments(self.h[which], self.x_a[which], self.x_b[which], self.length[which], self.sigma_t[which])

    def __len__(self) -> int:
        return self.h.size

    def astype(self, dtype: DTypeLike) -> Segments:
        """Round to another type: h, x_a, length and sigma_t; the end follows, as it does in a shader."""
        h, x_a, length, sigma_t = (a.astype(dtype) for a in (self.h, self.x_a, self.length, self.sigma_t))
        return Segments(h, x_a, x_a + length, length, sigma_t)

    @cached_property
    def optical_h(self) -> NDArray[np.floating]:
        """H = sigma_t h, (n,)."""
        return self.sigma_t * self.h

    @cached_property
    def d_a(self) -> NDArray[np.floating]:
        """Distance of the light from the eye, (n,) [scene unit]."""
        return np.hypot(self.h, self.x_a)

    @cached_property
    def d_b(self) -> NDArray[np.floating]:
        """Distance of the light from the segment's end, (n,) [scene unit]."""
        return np.hypot(self.h, self.x_b)

    @cached_property
    def depth_through_b(self) -> NDArray[np.floating]:
        """Optical depth from the light to the segment's end and back to the eye, (n,); 0 in a clear medium."""
        with np.errstate(invalid="ignore", over="ignore"):  # an infinite clear segment: inf * 0
            return np.where(self.sigma_t == 0, 0, self.sigma_t * (self.d_b + self.length))

    @cached_property
    def v_a(self) -> NDArray[np.floating]:
        """V = u + sqrt(1 + u^2) = tan(theta / 2) at the eye, (n,), theta the scattering angle."""
        return h_times_v(self.h, self.x_a) / self.h

    @cached_property
    def v_b(self) -> NDArray[np.floating]:
        """The same at the end, (n,), may be inf."""
        return h_times_v(self.h, self.x_b) / self.h

    @cached_property
    def difference_of_v(self) -> NDArray[np.floating]:
        """v_b - v_a, (n,), to the last digits: the difference of u + sqrt(1 + u^2) divided out, never subtracted."""
        finite = np.isfinite(self.x_b)
        end = np.where(finite, self.x_b, self.x_a)
        # (u_b - u_a) (v_a + v_b) / (sqrt(1 + u_a^2) + sqrt(1 + u_b^2)), in lengths instead of multiples of h
        ratio = (h_times_v(self.h, self.x_a) + h_times_v(self.h, end)) / (self.d_a + np.hypot(self.h, end))
        infinite = self.h.dtype.type(np.inf)
        return np.where(finite, self.length / self.h * ratio, infinite)

    @cached_property
    def through_light(self) -> NDArray[np.bool_]:
        """Where the limit h -> 0 is exact in float64: h vanishes against the segment's distance from the light, (n,).

        Nowhere does it where the segment contains the light's projection, for there is no finite limit.
        """
        return self.h <= self._negligible_h(NEGLIGIBLE)

    def beside_light(self, share: float = NEGLIGIBLE) -> Segments:
        """Raise h to what is negligible yet not 0, so that a ray through the light is an ordinary one.

        `share` is how much of its distance from the light a segment does not notice.
        """
        h = np.maximum(self.h, self._negligible_h(share))
        return Segments(h, self.x_a, self.x_b, self.length, self.sigma_t)

    def _negligible_h(self, share: float) -> NDArray[np.floating]:
        away = np.maximum(self.x_a, -self.x_b)
        return np.where(away > 0, np.maximum(share * away, np.finfo(away.dtype).tiny), 0)


def h_times_v(h: NDArray[np.floating], x: NDArray[np.floating]) -> NDArray[np.floating]:
    """Length h v = x + sqrt(h^2 + x^2), without cancellation before the projection: there h^2 / (sqrt(h^2 + x^2) - x).

    Parameters
    ----------
    h : ndarray, (...)  distance of the light from the ray, above 0 [scene unit]
    x : ndarray, (...)  position from the light's projection, may be inf [scene unit]

    Returns
    -------
    ndarray, (...)  h tan(theta / 2), theta the scattering angle [scene unit]

    Source: Weng 2010, section 4.3, v = u + sqrt(1 + u^2) with u = x / h.
    """
    d = np.hypot(h, x)
    return np.where(x > 0, x + d, h * (h / (d - np.minimum(x, 0))))


def half_angle(
    h: NDArray[np.floating], x: NDArray[np.floating], d: NDArray[np.floating]
) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """cos^2(theta / 2) and sin^2(theta / 2) at x, each (...), theta the scattering angle: cos theta = -x / d.

    The smaller one is divided out, never subtracted.

    Parameters
    ----------
    h, x, d : ndarray, (...)  distance of the light from the ray, position, distance of the light [scene unit]
    """
    tangent = h / (d + np.abs(x))
    smaller = tangent * tangent / (1 + tangent * tangent)
    before = x < 0
    return np.where(before, 1 - smaller, smaller), np.where(before, smaller, 1 - smaller)
