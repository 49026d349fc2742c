"""Scattering angles in Mitsuba's convention, without cancellation.

Both of Mitsuba's directions point away from the interaction: mi.wi to where the light comes from (or the eye), wo to
where it goes, in world space. Light that is not deflected has wo = -wi, so the scattering angle's cosine is -wi . wo;
measured on `hg` with g = 0.8 in 3.9.1: 3.581/sr at wo = -wi, 0.00491/sr at wo = wi.
"""

from __future__ import annotations

from typing import Any

from scenes.mitsuba_setup import mitsuba

mi = mitsuba()
import drjit as dr  # noqa: E402


def half_angle(wi: Any, wo: Any) -> tuple[Any, Any]:
    """Square of the cosine and of the sine of half the scattering angle.

    float32 has few digits left in 1 - cos theta, which decides a forward peak; |wo + wi|^2 = 4 sin^2(theta / 2) keeps
    them.

    Returns
    -------
    cos2, sin2 : Float
    """
    return 0.25 * dr.squared_norm(wo - wi), 0.25 * dr.squared_norm(wo + wi)


def direction(wi: Any, one_plus: Any, one_minus: Any, u: Any) -> Any:
    """Direction at a scattering angle.

    Parameters
    ----------
    wi : Vector3f                  as `MediumInteraction3f.wi`
    one_plus, one_minus : Float    1 + cos theta and 1 - cos theta
    u : Float                      azimuth as a share of the circle

    Returns
    -------
    wo : Vector3f
    """
    sine = dr.safe_sqrt(one_plus * one_minus)
    azimuth = 2 * dr.pi * u
    local = mi.Vector3f(sine * dr.cos(azimuth), sine * dr.sin(azimuth), 0.5 * (one_plus - one_minus))
    return mi.Frame3f(-wi).to_world(local)
