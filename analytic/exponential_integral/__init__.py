r"""The complex exponential integral: F(z) = e^z E1(z) and Ei(z), in float64 and in float32.

The closed forms of the isotropic airlight need the imaginary part of F: G(H, v) = -Im F(H (v + i)) (Weng 2010, Eqs. 20
and 21, with the exponents merged so that nothing overflows). Far from the light's projection that imaginary part is
much smaller than the real one (Im F ~ -Im z / |z|^2), so in the right half plane every step keeps the *relative*
accuracy of both parts: they are carried apart, and the sums that make the imaginary one add terms of one sign wherever
they can. The polynomial closed forms, as the thesis writes them, need Ei on both sides.

Three expansions, for the upper half plane; the lower one has the conjugate values:

=====================================  ==========================================  ========================
where                                  what                                        module
=====================================  ==========================================  ========================
Re z >= 0, \|z\| <= 1                  logarithmic series, multiplied by e^z       `series.scaled_series`
                                       term by term: no exponential
Re z < 0, \|z\| + Re z <= 1,           logarithmic series, then times e^z          `series.unscaled_series`
\|z\| < 45 (float32: 24)
elsewhere                              continued fraction with its tail; far out   `continued_fraction`
                                       short and without, even on the cut
=====================================  ==========================================  ========================

Worst relative error of the complex value / of the imaginary part alone in the right half plane R, of the complex value
in the left one L. Half of the points lie close to an axis, down to 1e-8 radian. float64 against 30 digits, about 1,500
points an entry; float32 against float64, about 100,000. By `experiments.atlas.exponential_integral_map.write_map`, with
scipy 1.17.1, e^z times its exp1:

============  =================  ========  =================  ========  =================  ========
\|z\|         float32, R         L         float64, R         L         scipy, R           L
============  =================  ========  =================  ========  =================  ========
1e-6 .. 0.3   1.9e-7 / 3.8e-7    3.1e-7    2.8e-16 / 3.3e-16  4.1e-16   5.2e-16 / 4.4e-16  4.1e-16
0.3 .. 0.6    3.3e-7 / 8.4e-7    3.1e-7    4.1e-16 / 7.8e-16  4.3e-16   5.4e-16 / 1.8e-15  4.7e-16
0.6 .. 0.8    4.7e-7 / 1.0e-6    3.5e-7    5.3e-16 / 1.6e-15  4.9e-16   1.0e-15 / 3.3e-15  5.6e-16
0.8 .. 1      5.7e-7 / 1.4e-6    3.4e-7    8.7e-16 / 1.8e-15  4.4e-16   1.6e-15 / 6.0e-15  6.2e-16
1 .. 2        3.6e-7 / 4.5e-7    4.0e-7    2.2e-15 / 1.3e-15  2.1e-15   1.7e-14 / 6.9e-14  2.0e-15
2 .. 6        3.2e-7 / 3.7e-7    4.3e-7    1.9e-15 / 1.6e-15  1.9e-15   1.7e-12 / 1.8e-11  9.7e-15
6 .. 20       2.2e-7 / 3.9e-7    9.9e-7    7.2e-16 / 6.7e-16  1.2e-15   1.9e-15 / 9.0e-15  2.1e-15
20 .. 24      2.0e-7 / 2.7e-7    1.5e-6    3.3e-16 / 4.4e-16  1.4e-15   1.0e-15 / 9.1e-15  1.8e-15
24 .. 45      2.3e-7 / 3.4e-7    2.2e-7    3.8e-16 / 4.4e-16  2.2e-15   9.7e-16 / 1.6e-14  2.2e-15
45 .. 300     2.2e-7 / 3.4e-7    2.0e-7    4.1e-16 / 4.4e-16  3.6e-16   8.1e-16 / 8.3e-14  8.6e-16
300 .. 1e3    1.9e-7 / 3.5e-7    2.0e-7    3.6e-16 / 4.4e-16  3.7e-16   7.7e-16 / 7.0e-11  6.9e-16
============  =================  ========  =================  ========  =================  ========

scipy sums the unscaled series up to |z| = 5, and loses there what it cancels; beyond |Re z| = 700, where the product
overflows or E1 is subnormal, it is not asked. Im F near the positive axis fades with the subnormal numbers before that.

Ei in the same sample, relative to max(|Ei|, 1) because it has zeros (0.3725, 3.007 +- 5.967i and infinitely many
more): scipy's expi 3.7e-15 at worst, ours in float32 1.6e-6. On the negative real axis, where Ei decays, scipy's
complex expi loses 1e-12 of the value near -5; `ei` does not.

The GLSL of the first quadrant's algorithm, run on llvmpipe, stays within 1.3 times the float32 column.
"""

from __future__ import annotations

from analytic.exponential_integral.scaled import scaled_e1
from analytic.exponential_integral.unscaled import ei

__all__ = ["ei", "scaled_e1"]
