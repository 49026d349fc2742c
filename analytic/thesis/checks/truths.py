"""What chapter 3 and Eqs. 13 to 15 are compared with: particles, thin slabs, a lamp of a finite size."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import Any

from mpmath import mp, mpf

from analytic.thesis.segment import Segment, integrate

__all__ = ["extrapolate", "lamp", "particles", "slabs"]

# halvings of a step
LEVELS = 12
SLAB_LEVELS = 9
AZIMUTHS = 4


def extrapolate(values: Sequence[Any], order: int = 1) -> Any:
    """Richardson: the limit of values at steps 1, 1/2, 1/4 ..., whose error is a series in step^order."""
    row = list(values)
    for k in range(1, len(row)):
        factor = mpf(2) ** (order * k)
        row = [(factor * fine - coarse) / (factor - 1) for coarse, fine in itertools.pairwise(row)]
    return row[0]


def particles(density: Any, cross_section: Any, x: Any) -> Any:
    """Share of light that a depth x of many small spheres lets through, each at a random place.

    Of a face A, each of the density A x particles shades cross_section / A, whatever the others do; then A grows.
    """
    faces = [20 * mpf(cross_section) * mpf(2) ** k for k in range(2 * LEVELS)]
    return extrapolate([(1 - cross_section / face) ** (density * face * x) for face in faces])


def slabs(
    L_0: Any,
    beta_ex: Callable[[Any], Any],
    added: Callable[[Any], Any],
    x: Any,
) -> Any:
    """Radiance behind a depth x of thin slabs, each of which removes beta_ex dx of the light amid it and adds to it.

    The light amid a slab is the mean of what enters and what leaves, so the error is a series in dx^2.
    """
    found = []
    for level in range(SLAB_LEVELS):
        count = 4 * 2**level
        dx, radiance = mpf(x) / count, mpf(L_0)
        for k in range(count):
            middle = (k + mpf(1) / 2) * dx
            lost = beta_ex(middle) * dx / 2
            radiance = (radiance * (1 - lost) + added(middle) * dx) / (1 + lost)
        found.append(radiance)
    return extrapolate(found, 2)


def lamp(segment: Segment, x: Any, phase: Callable[[Any], Any]) -> Any:
    """Light that a small glowing sphere of unit intensity sends through x and, weighted by `phase`, on to the eye.

    The sphere of radius r around the light has the radiance 1 / (pi r^2) and no medium inside; the ray's direction, the
    light's and the eye's are vectors; r goes to 0.

    Returns
    -------
    mpf  int L_i Phi d omega at x; with Phi = 1 the fluence rate
    """
    d = segment.d(x)
    # what the direction to the lamp's centre, and the one at right angles in the plane, have along x
    towards_lamp, across = (mpf(segment.x_h) - mpf(x)) / d, mpf(segment.h) / d
    # Gauss-Chebyshev: the mean over a circle of a function of the cosine
    azimuths = [mp.cos(mp.pi * (2 * k + 1) / (2 * AZIMUTHS)) for k in range(AZIMUTHS)]
    kappa_t = mpf(segment.kappa_t)
    found = []
    for level in range(LEVELS):
        r = d / 20 / 2**level

        def ring(beta: Any, r: Any = r) -> Any:
            # sin alpha = (r / d) sin beta: alpha from the centre, beta the angle at which the ray meets the sphere
            sine = r / d * mp.sin(beta)
            cosine = mp.sqrt(1 - sine**2)
            distance = d * cosine - r * mp.cos(beta)
            # light travels against the direction towards it, the eye lies along -x: the signs cancel
            towards = (cosine * towards_lamp + sine * azimuth * across for azimuth in azimuths)
            scattered = mp.fsum(phase(cosine_x) for cosine_x in towards) / AZIMUTHS
            d_omega = 2 * mp.pi * sine * (r / d) * mp.cos(beta) / cosine
            return mp.exp(-kappa_t * distance) / (mp.pi * r**2) * scattered * d_omega

        found.append(integrate(ring, [mpf(0), mp.pi / 2]))
    return extrapolate(found)
