"""The phase function of Cornette and Shanks as a Mitsuba plugin."""

from __future__ import annotations

from typing import Any

from reference.plugins.scattering_angle import direction, half_angle
from scenes.mitsuba_setup import mitsuba

mi = mitsuba()
import drjit as dr  # noqa: E402

# measured from t = 2 u: off by 6e-5 after two steps, 2e-9 after three, whatever g and u are; float32 sees 1e-7
NEWTON_STEPS = 3


class CornetteShanks(mi.PhaseFunction):  # type: ignore[name-defined]
    r"""Cornette and Shanks' phase function (:monosp:`cornette_shanks`).

    .. pluginparameters::

     * - g
       - |float|
       - Between -1 and 1, both excluded. Positive values scatter forward, negative ones backward. It is not the mean
         cosine, which is 3 g (4 + g^2) / (5 (2 + g^2)). (Default: 0.8)
       - |exposed|, |differentiable|

    `hg` times 3 (1 + cos^2 theta) / (4 + 2 g^2), which is `rayleigh` at g = 0. Sampled to float32's last digit, by
    Newton's inversion of the closed distribution function. Source: Cornette and Shanks 1992, Eq. 8.
    """

    def __init__(self, props: Any) -> None:
        super().__init__(props)
        g = props.get("g", 0.8)
        if not abs(g) < 1:
            raise ValueError(f"g must lie strictly between -1 and 1: {g}")
        self.g = mi.Float(g)
        self.m_flags = mi.PhaseFunctionFlags.Anisotropic

    def eval_pdf(self, ctx: Any, mei: Any, wo: Any, active: Any = True) -> tuple[Any, Any]:
        """Value and density [1/sr], which are the same number."""
        cos2, sin2 = half_angle(mei.wi, wo)
        value = dr.select(active, self._value(cos2, sin2), 0.0)
        return mi.Spectrum(value), value

    def sample(self, ctx: Any, mei: Any, sample1: Any, sample2: Any, active: Any = True) -> tuple[Any, Any, Any]:
        """Direction, weight 1, and density [1/sr]."""
        # backward peaks are mirrored forward ones, and for 0 <= g < 1 no two terms below cancel by more than a digit
        g, mirrored = dr.abs(self.g), self.g < 0
        tail, squared = 1 - g, dr.square(1 + g)
        # t from 0 to 2 is twice the distribution function of `hg`, which gives 1 + cos theta = (1 + g)^2 t (1 - g + g t
        # / 2) / D^2 with D = 1 - g + g t. The density of t is then 1 + cos^2 theta, and its integral from 0
        #     2 t - (1 + g)^2 t^2 / D + (1 + g)^4 t^3 (3 D + 1 - g) / (12 D^3),
        # nearly straight, since the slope stays between 1 and 2
        wanted = sample2.x * (8 + 4 * dr.square(g)) / 3
        t = 2 * sample2.x
        for _ in range(NEWTON_STEPS):
            D = tail + g * t
            a = squared * t / D
            integral = t * (2 - a + dr.square(a) * (3 + tail / D) / 12)
            cosine = a * (tail + 0.5 * g * t) / D - 1
            t = dr.clip(t - (integral - wanted) / (1 + dr.square(cosine)), 0.0, 2.0)
        D = tail + g * t
        near = squared * t * (tail + 0.5 * g * t) / dr.square(D)
        far = dr.square(tail) * (2 - t) * (1 + g + D) / (2 * dr.square(D))
        one_plus, one_minus = dr.select(mirrored, far, near), dr.select(mirrored, near, far)
        value = dr.select(active, self._value(0.5 * one_plus, 0.5 * one_minus), 0.0)
        return direction(mei.wi, one_plus, one_minus, sample2.y), mi.Spectrum(1.0), value

    def _value(self, cos2: Any, sin2: Any) -> Any:
        """Value [1/sr] at the squares of the cosine and the sine of half the scattering angle."""
        g = dr.abs(self.g)
        base = dr.square(1 - g) + 4 * g * dr.select(self.g > 0, sin2, cos2)
        hg = dr.inv_four_pi * (1 - g) * (1 + g) / (base * dr.sqrt(base))
        return 1.5 / (2 + dr.square(g)) * (1 + dr.square(cos2 - sin2)) * hg

    def traverse(self, callback: Any) -> None:
        """Expose `g`."""
        callback.put("g", self.g, mi.ParamFlags.Differentiable)

    def to_string(self) -> str:
        """Name the plugin and its parameter."""
        return f"CornetteShanks[\n  g = {self.g}\n]"


mi.register_phase("cornette_shanks", CornetteShanks)
