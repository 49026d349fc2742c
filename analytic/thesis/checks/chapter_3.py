"""Eqs. 1 to 12 against particles and thin slabs."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from mpmath import mp, mpf

from analytic.thesis import absorption_and_scattering as thesis
from analytic.thesis.checks.entry import Entry, conclude, largest, relative, shown
from analytic.thesis.checks.parameters import HG, PHASES, RAYLEIGH, henyey_greenstein, isotropic
from analytic.thesis.checks.truths import extrapolate, particles, slabs

__all__ = ["CHECKS"]

G = 0.6
# density and cross section of absorbing and of scattering particles, and depths
ABSORBING = mpf("0.9"), mpf("0.25")
SCATTERING = mpf("2.5"), mpf("0.12")
DEPTHS = (mpf("0.1"), mpf(1), mpf(5))
# the medium that varies: exponentials and a ramp, absorption included in the first two
VARYING: list[Callable[[Any], Any]] = [
    lambda x: mpf("0.7") * mp.exp(-x / 2),
    lambda x: mpf("0.2") + mpf("0.3") * x,
    lambda x: mpf("0.4") * (1 + mp.cos(x)),
]
ALBEDO = mpf("0.8")
SLIP = "beta x' dx' stands for beta(x') dx'"
SCHLICK_K, CORNETTE_SHANKS_G = mpf("0.5"), mpf("0.3")


def _thin_box(equation: str, law: Callable[[Any, Any], Any], kind: tuple[Any, Any], what: str) -> Entry:
    density, cross_section = kind
    steps = [mpf(2) ** -k / 8 for k in range(12)]
    lost = extrapolate([(1 - particles(density, cross_section, dx)) / dx for dx in steps])
    error = relative(law(density * cross_section, mpf(1)), lost)
    return conclude(
        equation,
        error,
        f"The share of light that a thin box of {what} particles removes, per depth, has the coefficient as its limit: "
        f"the two differ by {shown(error)}.",
    )


def _constant(equation: str, law: Callable[[Any, Any, Any], Any], kind: tuple[Any, Any], what: str) -> Entry:
    density, cross_section = kind
    error = largest(relative(law(1, density * cross_section, x), particles(density, cross_section, x)) for x in DEPTHS)
    return conclude(
        equation,
        error,
        f"A depth of {', '.join(shown(x) for x in DEPTHS)} of randomly placed {what} particles lets through what the "
        f"equation says: largest difference {shown(error)}.",
    )


def _varying(equation: str, printed_product: Any, printed_at_the_end: Any, repaired: Any) -> Entry:
    truths = [(beta, x, slabs(1, beta, lambda x: 0, x)) for beta in VARYING for x in DEPTHS[1:]]

    def error(reading: Any) -> Any:
        return largest(relative(reading(1, beta, x), truth) for beta, x, truth in truths)

    product, at_the_end, right = error(printed_product), error(printed_at_the_end), error(repaired)
    return conclude(
        equation,
        min(product, at_the_end),
        f"Against thin slabs of three media that vary, the exponent beta(x') x' is off by up to {shown(product)}, and "
        f"beta(x) x' by up to {shown(at_the_end)}; with beta(x') dx' {shown(right)} is left.",
        right,
        SLIP,
    )


def equation_1() -> Entry:
    """Absorption in a thin box."""
    return _thin_box("1", thesis.eq_1, ABSORBING, "absorbing")


def equation_2() -> Entry:
    """Absorption over a depth."""
    return _constant("2", thesis.eq_2, ABSORBING, "absorbing")


def equation_3() -> Entry:
    """Absorption that varies."""
    return _varying("3", thesis.eq_3_printed_product, thesis.eq_3_printed_at_the_end, thesis.eq_3_repaired)


def equation_4() -> Entry:
    """Scattering out of the ray in a thin box."""
    return _thin_box("4", thesis.eq_4, SCATTERING, "scattering")


def equation_5() -> Entry:
    """Scattering out of the ray over a depth."""
    return _constant("5", thesis.eq_5, SCATTERING, "scattering")


def equation_6() -> Entry:
    """Scattering out of the ray that varies."""
    return _varying("6", thesis.eq_6_printed_product, thesis.eq_6_printed_at_the_end, thesis.eq_6_repaired)


def printed_rayleigh(cosine: Any) -> Any:
    """3/4 (1 + cos^2), chapter 5."""
    return mpf(3) / 4 * (1 + cosine**2)


def equation_7() -> Entry:
    """The phase function's integral."""
    lobe = henyey_greenstein(float(CORNETTE_SHANKS_G))
    others = [
        lambda cosine: (1 - SCHLICK_K**2) / (4 * mp.pi * (1 - SCHLICK_K * cosine) ** 2),
        lambda cosine: 3 * (1 + cosine**2) / (4 + 2 * CORNETTE_SHANKS_G**2) * lobe(cosine),
    ]
    error = largest(abs(thesis.eq_7(function) - 1) for function in [*(p.of_cosine for p in PHASES), *others])
    chapter_5 = thesis.eq_7(printed_rayleigh)
    ratio = chapter_5 / thesis.eq_7(isotropic)
    return conclude(
        "7",
        error,
        f"The isotropic, Rayleigh, Henyey-Greenstein, Schlick and Cornette-Shanks functions integrate to 1 within "
        f"{shown(error)}. Chapter 5's Rayleigh function 3/4 (1 + cos^2) does not: it integrates to "
        f"{mp.nstr(chapter_5, 8)} (4 pi is {mp.nstr(4 * mp.pi, 8)}), so Figure 5.3's anisotropic panel is "
        f"{mp.nstr(ratio, 4)} times too bright beside the isotropic one; 3/(16 pi) (1 + cos^2) is right.",
    )


def equation_8() -> Entry:
    """Light that is scattered towards the eye, of a field whose harmonics are known to be weakened by g^l."""
    lobe = largest(relative(thesis.eq_8(partial(mp.legendre, n), HG.of_cosine), mpf(G) ** n) for n in range(4))
    second = relative(thesis.eq_8(lambda c: mp.legendre(2, c), RAYLEIGH.of_cosine), mpf(1) / 10)
    error = max(lobe, second)
    return conclude(
        "8",
        error,
        f"Fields that vary as Legendre polynomials come back weakened by g^l from Henyey and Greenstein's lobe, and by "
        f"1/10 (l = 2) from Rayleigh's: within {shown(error)}.",
    )


def equation_9() -> Entry:
    """Light that a thin slab adds."""
    beta_ex, source = mpf("0.5"), thesis.eq_8(lambda c: 1 + c, HG.of_cosine)
    beta_sc = ALBEDO * beta_ex
    steps = [mpf(2) ** -k / 4 for k in range(14)]
    slope = extrapolate([slabs(0, lambda x: beta_ex, lambda x: beta_sc * source, dx) / dx for dx in steps])
    error = relative(thesis.eq_9(beta_sc, 1, 1 + mpf(G)), slope)
    return conclude(
        "9", error, f"What a thin slab sends on when nothing enters it, per depth: the same within {shown(error)}."
    )


def equation_10() -> Entry:
    """The balance, of particles in a uniform field: they scatter a share, the albedo, of what they take out of it."""
    density, cross_section = SCATTERING
    beta_ex, field, entering = density * cross_section, mpf("0.6"), mpf("1.7")

    def leaving(dx: Any) -> Any:
        passed = particles(density, cross_section, dx)
        return entering * passed + (1 - passed) * ALBEDO * field

    slope = extrapolate([(leaving(dx) - entering) / dx for dx in (mpf(2) ** -k / 8 for k in range(12))])
    inscattered = thesis.eq_8(lambda c: field, HG.of_cosine)
    error = relative(thesis.eq_10(beta_ex, ALBEDO * beta_ex, entering, inscattered), slope)
    still = abs(thesis.eq_10(beta_ex, beta_ex, field, inscattered))
    return conclude(
        "10",
        max(error, still),
        f"The slope behind a thin box of particles in a uniform field is the equation's within {shown(error)}; without "
        f"absorption a uniform field stays as it is ({shown(still)}).",
    )


def _glow(x: Any) -> Any:
    """Integral of L_i Phi over the sphere."""
    return 1 + x / 3


def _slabs_that_glow(L_0: Any, beta_ex: Callable[[Any], Any], x: Any) -> Any:
    return slabs(L_0, beta_ex, lambda s: ALBEDO * beta_ex(s) * _glow(s), x)


def equation_11() -> Entry:
    """The solution of Eq. 10 in a medium that varies."""
    entering, x = mpf("1.5"), mpf(2)
    truths = [(beta, _slabs_that_glow(entering, beta, x)) for beta in VARYING]

    def error(reading: Any) -> Any:
        return largest(
            relative(reading(entering, beta, lambda s, beta=beta: ALBEDO * beta(s), _glow, x), truth)
            for beta, truth in truths
        )

    product, at_the_end = error(thesis.eq_11_printed_product), error(thesis.eq_11_printed_at_the_end)
    right = error(thesis.eq_11_repaired)
    return conclude(
        "11",
        min(product, at_the_end),
        f"Against thin slabs that absorb and glow: off by up to {shown(product)} with beta(x') x', by up to "
        f"{shown(at_the_end)} with every coefficient taken at x, for the print also drops the arguments of beta_sc and "
        f"L_i; with beta(x') dx' and the arguments {shown(right)} is left.",
        right,
        SLIP + ", and beta_sc and L_i have lost their arguments",
    )


def equation_12() -> Entry:
    """One factor and one addend."""
    beta, x, entering = VARYING[0], mpf(2), mpf("1.5")
    whole = _slabs_that_glow(entering, beta, x)
    passed, added = slabs(1, beta, lambda s: 0, x), _slabs_that_glow(0, beta, x)
    error = relative(thesis.eq_12(entering, passed, added), whole)
    return conclude(
        "12", error, f"Slabs that only dim and slabs that only glow add up to slabs that do both within {shown(error)}."
    )


CHECKS = (
    equation_1,
    equation_2,
    equation_3,
    equation_4,
    equation_5,
    equation_6,
    equation_7,
    equation_8,
    equation_9,
    equation_10,
    equation_11,
    equation_12,
)
