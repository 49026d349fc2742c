r"""Section 4.2 of Weng 2010 and the head of 4.3, Eqs. 13 to 17: the airlight of a point light as an integral.

Eq. 13 says phi = 180 - theta without saying which angle theta is. Chapter 3 calls the scattering angle theta; then phi
is its supplement and forward scattering becomes backward. Read as the angle between the directions *to* the light and
*to* the eye, as Figure 4.6 suggests, phi is the scattering angle, and Eqs. 16 and 17 agree with that.

Each of Eqs. 14 to 17 gives radiance for I = 1 and, Eq. 14 apart, kappa_s = 1, of a homogeneous medium.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmath import mp, mpf

from analytic.thesis.first_formulation import PhaseOfCosine, prefactor_repaired
from analytic.thesis.segment import Segment, integrate


def eq_13(
    L_b: Any,
    beta_ex: Callable[[Any], Any],
    beta_sc: Callable[[Any], Any],
    inscattered: Callable[[Any], Any],
    cuts: list[Any],
) -> Any:
    """Radiance at x_a of a ray from x_b, where L_b starts; `inscattered` is the integral over the sphere at x."""

    def source(x: Any) -> Any:
        return mp.exp(-integrate(beta_ex, [cuts[0], x])) * beta_sc(x) * inscattered(x)

    return L_b * mp.exp(-integrate(beta_ex, cuts)) + integrate(source, cuts)


def phi(theta: Any) -> Any:
    """Eq. 13's 180 - theta, in radians."""
    return mp.pi - theta


def eq_14_source(kappa_s: Any, L_i: Any, phase: PhaseOfCosine, cos_phi: Any) -> Any:
    """kappa_s L_i Phi: what the integrand of Eq. 14 has beside the transmittance; L_i is an irradiance here."""
    return kappa_s * L_i * phase(cos_phi)


def eq_15(segment: Segment, x: Any) -> Any:
    """L_i(x): what arrives from the light, dimmed."""
    return mp.exp(-mpf(segment.kappa_t) * segment.d(x)) / segment.d(x) ** 2


def eq_14(segment: Segment, phase: PhaseOfCosine) -> Any:
    """Eq. 14 with Eq. 15's L_i, without L_b."""

    def integrand(x: Any) -> Any:
        dimming = mp.exp(-mpf(segment.kappa_t) * (x - mpf(segment.x_a)))
        cos_phi = -(x - mpf(segment.x_h)) / segment.d(x)
        return dimming * eq_14_source(1, eq_15(segment, x), phase, cos_phi)

    return integrate(integrand, segment.cuts)


def eq_16(segment: Segment, phase: PhaseOfCosine) -> Any:
    """L_m of Eq. 16, Phi of the angle arctan((x - x_h) / h) + pi / 2."""
    kappa_t = mpf(segment.kappa_t)

    def integrand(x: Any) -> Any:
        angle = mp.atan(segment.u(x)) + mp.pi / 2
        return mp.exp(-kappa_t * (x + segment.d(x))) / segment.d(x) ** 2 * phase(mp.cos(angle))

    return mp.exp(kappa_t * mpf(segment.x_a)) * integrate(integrand, segment.cuts)


def eq_17(segment: Segment, phase: PhaseOfCosine) -> Any:
    """L_m by u; Phi_c takes the cosine."""

    def integrand(u: Any) -> Any:
        root = mp.sqrt(1 + u * u)
        return mp.exp(-segment.H * (u + root)) / (1 + u * u) * phase(-u / root)

    return prefactor_repaired(segment) * integrate(integrand, map(segment.u, segment.cuts))
