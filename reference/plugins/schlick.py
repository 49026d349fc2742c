"""The phase function of Blasi, Le Saec and Schlick as a Mitsuba plugin."""

from __future__ import annotations

from typing import Any

from reference.plugins.scattering_angle import direction, half_angle
from scenes.mitsuba_setup import mitsuba

mi = mitsuba()
import drjit as dr  # noqa: E402


class Schlick(mi.PhaseFunction):  # type: ignore[name-defined]
    r"""Schlick's phase function (:monosp:`schlick`).

    .. pluginparameters::

     * - k
       - |float|
       - Between -1 and 1, both excluded. Positive values scatter forward, negative ones backward. (Default: 0.5)
       - |exposed|, |differentiable|

    (1 - k^2) / (4 pi (1 - k cos theta)^2) [1/sr]; sampled exactly, by inversion.

    Source: Blasi, Le Saec and Schlick 1993.
    """

    def __init__(self, props: Any) -> None:
        super().__init__(props)
        k = props.get("k", 0.5)
        if not abs(k) < 1:
            raise ValueError(f"k must lie strictly between -1 and 1: {k}")
        self.k = mi.Float(k)
        self.m_flags = mi.PhaseFunctionFlags.Anisotropic

    def eval_pdf(self, ctx: Any, mei: Any, wo: Any, active: Any = True) -> tuple[Any, Any]:
        """Value and density [1/sr], which are the same number."""
        cos2, sin2 = half_angle(mei.wi, wo)
        value = dr.select(active, self._value(dr.select(self.k > 0, sin2, cos2)), 0.0)
        return mi.Spectrum(value), value

    def sample(self, ctx: Any, mei: Any, sample1: Any, sample2: Any, active: Any = True) -> tuple[Any, Any, Any]:
        """Direction, weight 1, and density [1/sr]."""
        # the distribution function of cos theta inverted: (y + k) / (1 + k y) with y uniform from -1 to 1
        below = 1 - self.k + 2 * self.k * sample2.x
        one_plus = 2 * sample2.x * (1 + self.k) / below
        one_minus = 2 * (1 - sample2.x) * (1 - self.k) / below
        value = self._value(0.5 * dr.select(self.k > 0, one_minus, one_plus))
        return direction(mei.wi, one_plus, one_minus, sample2.y), mi.Spectrum(1.0), dr.select(active, value, 0.0)

    def _value(self, from_peak: Any) -> Any:
        """Value [1/sr] at (1 - cos) / 2 of the angle from the peak."""
        k = dr.abs(self.k)
        return dr.inv_four_pi * (1 - k) * (1 + k) / dr.square(1 - k + 2 * k * from_peak)

    def traverse(self, callback: Any) -> None:
        """Expose `k`."""
        callback.put("k", self.k, mi.ParamFlags.Differentiable)

    def to_string(self) -> str:
        """Name the plugin and its parameter."""
        return f"Schlick[\n  k = {self.k}\n]"


mi.register_phase("schlick", Schlick)
