r"""The airlight to as many digits as asked, with a proven bound of its error; the truth that the rest is judged by.

With x = h sinh s, v = e^s = tan(theta / 2), d = h cosh s, cos theta = -tanh s and t = s - s_a, Eq. 16 becomes

    L / (I sigma_s) = (1 / h) e^{-sigma_t d_a} int_0^{t_b} e^{-H v_a (e^t - 1)} p(-tanh s) / cosh s dt,   H = sigma_t h.

For h = 0 beside the light it is p(-1) / x_a e^{-sigma_t x_a} int e^{-2 sigma_t x_a (e^t - 1)} e^{-t} dt behind the
light, and p(1) e^{-sigma_t |x_a|} (1 / |x_b| - 1 / |x_a|) before it.

**Truncation.** The range of t is cut at the kinks of a table and halved until each panel's bound is small enough. Let a
panel be c - w <= t <= c + w. Its integrand is analytic but at |Im t| = pi / 2 (or entire), for every phase function of
`analytic.oracle.phases`, so it is analytic in the ellipse c + w (z + 1 / z) / 2, 1 <= |z| <= rho, if
b = w (rho - 1 / rho) / 2 < pi / 2. There |Im t| <= b and |Re t - c| <= a = w (rho + 1 / rho) / 2, so for s = x + i y

    |cosh s| = sqrt(sinh^2 x + cos^2 y) >= cos b cosh x,
    |e^{-H v_a (e^t - 1)}| <= exp(-H v_a (e^{c - a} cos b - 1)),

and p has the bound that its file proves. Their product is M. A function bounded by M in that ellipse has Chebyshev
coefficients |a_k| <= 2 M rho^{-k}; the rule of n >= 2 Gauss nodes is exact to degree 2 n - 1 and for odd k, its weights
are positive and add up to 2, and |int T_k| = 2 / (k^2 - 1) for even k, so that on [-1, 1]

    |error| <= sum_{k = 2n, 2n + 2, ...} 2 M rho^{-k} (2 + 2 / (k^2 - 1)) <= (64 / 15) M rho^{-2n} / (1 - rho^{-2}).

(It is the bound of Trefethen 2008, SIAM Review 50(1), Theorem 4.5, but for how the nodes are counted; here they are n.)
Any rho gives a bound; the least of a few is taken. The bounds are found in float64, as logarithms that are off by less
than 1e-6, which is added.

**The far end.** Where the integrand has become too small to matter, at t_c, the rest is left out: it is at most
max p e^{-H v_a (e^{t_c} - 1)} int_{t_c} dt / cosh s, and 1 / cosh s < 2 e^{-s}. That bound is added.

**Rounding.** Let eps = 2^-precision and T the largest t. A node t is off by less than 4 T eps, so v = v_a e^t, v_a a
sum of positive terms or one over such a sum, by less than (8 + 4 T) eps relative. p / cosh s is made from v by at most
40 operations of positive terms and answers to an error of v with a factor of at most 5: in all less than
(80 + 20 T) eps. A table's line alone has terms of both signs, in its two coefficients and between them; there the same
is true relative to its `size`, in which every subtraction is a sum. (Its M is a bound of that size, too, so the
rounding of the coefficients does not make it false.) The exponent H v_a (e^t - 1), which may cancel, is off by less
than (16 + 8 T) H v eps absolutely, and that of e^{-sigma_t d_a} by 4 sigma_t d_a eps. N terms in a row add N eps.
So the sum is off by less than 100 (1 + T) (1 + H v + sigma_t d_a) eps + N eps of the sum of the terms' sizes. An end or
a kink is off by less than 8 eps (1 + |s|), times the integrand there, which is at most the M of the panel beside it.
The precision has as many guard digits as log10 of the optical depth and of 1 / t_b. Where truncation or rounding is
still too large for the value that was found, panels become finer or digits more by what was lacking: the bound that is
given is what was met.
"""

from __future__ import annotations

from analytic.oracle.airlight import Exact, exact_airlight

__all__ = ["Exact", "exact_airlight"]
