"""Eqs. 13 to 17 against thin slabs, a small lamp and the oracle."""

from __future__ import annotations

from functools import partial
from typing import Any

from mpmath import mp, mpf

from analytic.thesis import absorption_and_scattering
from analytic.thesis import transport as thesis
from analytic.thesis.checks.entry import Entry, conclude, largest, relative, shown
from analytic.thesis.checks.parameters import HG, RAYLEIGH, SEGMENTS, airlight, with_phases
from analytic.thesis.checks.truths import lamp, slabs

__all__ = ["CHECKS"]

G = 0.6
# three scales, and places before, beside and behind the light's projection
LAMPS = [(SEGMENTS[k], mpf(x)) for k, x in ((10, "-0.5"), (19, "0.5"), (22, "1.75"), (34, "-0.875"))]
END = mpf(3)


def equation_13() -> Entry:
    """The whole equation in a medium and a field that vary."""

    def beta_ex(x: Any) -> Any:
        return mpf("0.3") * (1 + x / 4)

    def beta_sc(x: Any) -> Any:
        return mpf("0.25") * mp.exp(-x / 5)

    # light at x from all sides: 1 + a(x) c + 0.2 P_2(c), c the cosine between its direction and that to the eye
    strengths = [lambda x: mpf(1), lambda x: mpf("0.6") - x / 10, lambda x: mpf("0.2")]

    def by_the_equation(sign: int) -> Any:
        """Sign 1: theta is between the directions to the light and to the eye; -1: theta is the scattering angle."""
        integrals = [
            absorption_and_scattering.eq_8(
                partial(mp.legendre, n), lambda c: HG.of_cosine(mp.cos(thesis.phi(mp.acos(-sign * c))))
            )
            for n in range(3)
        ]
        cuts = [END * k / 4 for k in range(5)]

        def inscattered(x: Any) -> Any:
            return mp.fsum(strength(x) * integral for strength, integral in zip(strengths, integrals, strict=True))

        return thesis.eq_13(mpf("1.5"), beta_ex, beta_sc, inscattered, cuts)

    def glow(x: Any) -> Any:
        """The lobe weakens the l-th harmonic by g^l."""
        return beta_sc(x) * mp.fsum(strength(x) * mpf(G) ** n for n, strength in enumerate(strengths))

    # slabs are counted from where the ray starts, towards the eye
    truth = slabs(mpf("1.5"), lambda s: beta_ex(END - s), lambda s: glow(END - s), END)
    right, other = relative(by_the_equation(1), truth), relative(by_the_equation(-1), truth)
    return conclude(
        "13",
        right,
        f"Against thin slabs, Henyey-Greenstein 0.6: {shown(right)} if theta is the angle between the directions to "
        f"the light and to the eye, so that phi is the scattering angle; if theta were the scattering angle, as in "
        f"chapter 3, phi would be its supplement and the radiance off by {shown(other)}.",
    )


def equation_14() -> Entry:
    """The source at a point, and the whole against the oracle."""
    source = largest(
        relative(
            thesis.eq_14_source(1, thesis.eq_15(segment, x), p.of_cosine, (mpf(segment.x_h) - x) / segment.d(x)),
            lamp(segment, x, p.of_cosine),
        )
        for segment, x in LAMPS
        for p in (RAYLEIGH, HG)
    )
    whole = largest(relative(thesis.eq_14(s, p.of_cosine), airlight(s, p.exact)) for s, p in with_phases())
    return conclude(
        "14",
        max(source, whole),
        f"A lamp whose radius goes to 0 sends towards the eye what the equation says within {shown(source)}, and over "
        f"{len(SEGMENTS)} segments the integral is the oracle's within {shown(whole)}. L_i has become an irradiance: "
        "Eq. 13's was a radiance.",
    )


def equation_15() -> Entry:
    """Light that arrives from the lamp."""
    error = largest(relative(thesis.eq_15(segment, x), lamp(segment, x, lambda cosine: 1)) for segment, x in LAMPS)
    return conclude(
        "15",
        error,
        f"The same as the fluence of a lamp whose radius goes to 0, within {shown(error)}; I is an intensity, and what "
        "the text calls incoming radiance is an irradiance.",
    )


def equation_16() -> Entry:
    """The airlight as an integral over x."""
    error = largest(relative(thesis.eq_16(s, p.of_cosine), airlight(s, p.exact)) for s, p in with_phases())
    backwards = largest(
        relative(thesis.eq_16(s, lambda cosine: HG.of_cosine(-cosine)), airlight(s, HG.exact)) for s in SEGMENTS[:3]
    )
    return conclude(
        "16",
        error,
        f"The oracle's airlight within {shown(error)} over {len(SEGMENTS)} segments. Its phi is the scattering angle: "
        f"with the supplement Henyey-Greenstein 0.6 is off by up to {shown(backwards)}.",
    )


def equation_17() -> Entry:
    """The airlight as an integral over u."""
    error = largest(relative(thesis.eq_17(s, p.of_cosine), airlight(s, p.exact)) for s, p in with_phases())
    return conclude("17", error, f"The oracle's airlight within {shown(error)} over {len(SEGMENTS)} segments.")


CHECKS = (equation_13, equation_14, equation_15, equation_16, equation_17)
