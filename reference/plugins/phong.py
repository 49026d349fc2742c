"""The modified Phong BSDF as a Mitsuba plugin."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from scenes.mitsuba_setup import mitsuba

mi = mitsuba()
import drjit as dr  # noqa: E402

GLOSSY, DIFFUSE = 0, 1


class Phong(mi.BSDF):  # type: ignore[name-defined]
    r"""Modified Phong BSDF (:monosp:`phong`).

    .. pluginparameters::

     * - diffuse_reflectance
       - |spectrum|, |texture| or |float|
       - kd, the albedo of the diffuse part. (Default: 0.5)
       - |exposed|, |differentiable|
     * - specular_reflectance
       - |spectrum|, |texture| or |float|
       - ks, the albedo of the glossy part at normal incidence. (Default: 0.2)
       - |exposed|, |differentiable|
     * - exponent
       - |float|
       - n >= 0, the sharpness of the highlight. (Default: 30)
       - |exposed|, |differentiable|

    f = kd / pi + ks (n + 2) / (2 pi) max(cos alpha, 0)^n [1/sr], alpha the angle between wo and the mirrored wi. Black
    from behind, as `diffuse` is; put it inside `twosided` for both sides. It is reciprocal, and reflects no more than
    kd + ks of what it receives; a sum above 1 is computed as it stands. Source: Lafortune and Willems 1994, Eqs. 4-10.
    """

    def __init__(self, props: Any) -> None:
        super().__init__(props)
        self.diffuse = props.get_texture("diffuse_reflectance", 0.5)
        self.specular = props.get_texture("specular_reflectance", 0.2)
        exponent = props.get("exponent", 30.0)
        if not 0 <= exponent < float("inf"):
            raise ValueError(f"exponent must be finite and not negative: {exponent}")
        self.exponent = mi.Float(exponent)
        glossy = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
        diffuse = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.FrontSide
        if self.specular.is_spatially_varying():
            glossy |= mi.BSDFFlags.SpatiallyVarying
        if self.diffuse.is_spatially_varying():
            diffuse |= mi.BSDFFlags.SpatiallyVarying
        self.m_components = [glossy, diffuse]
        self.m_flags = glossy | diffuse
        self.parameters_changed()

    def parameters_changed(self, keys: Sequence[str] = ()) -> None:
        """Share the samples between the parts by their mean albedos."""
        diffuse, specular = self.diffuse.mean(), self.specular.mean()
        total = diffuse + specular
        self.glossy_share = dr.select(total > 0, specular / dr.select(total > 0, total, 1.0), 0.5)

    def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        """Value [1/sr] times the cosine of wo."""
        lit = active & (si.wi.z > 0) & (wo.z > 0)
        value = mi.Spectrum(0.0)
        if ctx.is_enabled(mi.BSDFFlags.GlossyReflection, GLOSSY):
            lobe = (self.exponent + 2) * dr.inv_two_pi * self._peak(si, wo)
            value = value + self.specular.eval(si, lit) * lobe
        if ctx.is_enabled(mi.BSDFFlags.DiffuseReflection, DIFFUSE):
            value = value + self.diffuse.eval(si, lit) * dr.inv_pi
        return dr.select(lit, value * wo.z, 0.0)

    def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        """Density [1/sr] with which `sample` gives wo; what it sends below the surface is missing from the integral."""
        lit = active & (si.wi.z > 0) & (wo.z > 0)
        share = self._share(ctx)
        glossy = (self.exponent + 1) * dr.inv_two_pi * self._peak(si, wo)
        return dr.select(lit, share * glossy + (1 - share) * wo.z * dr.inv_pi, 0.0) * self._any(ctx)

    def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> tuple[Any, Any]:
        """Both of the above."""
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> tuple[Any, Any]:
        """Direction by one of the two parts, with the density of both; weight 0 where it points below the surface."""
        glossy = sample1 < self._share(ctx)
        cosine = dr.power(sample2.x, 1 / (self.exponent + 1))
        sine = dr.safe_sqrt((1 - cosine) * (1 + cosine))
        azimuth = 2 * dr.pi * sample2.y
        around = mi.Vector3f(sine * dr.cos(azimuth), sine * dr.sin(azimuth), cosine)
        mirrored = mi.Frame3f(mi.reflect(si.wi)).to_world(around)

        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo = dr.select(glossy, mirrored, mi.warp.square_to_cosine_hemisphere(sample2))
        bs.eta = 1.0
        bs.sampled_type = dr.select(
            glossy, mi.UInt32(+mi.BSDFFlags.GlossyReflection), mi.UInt32(+mi.BSDFFlags.DiffuseReflection)
        )
        bs.sampled_component = dr.select(glossy, mi.UInt32(GLOSSY), mi.UInt32(DIFFUSE))
        bs.pdf = self.pdf(ctx, si, bs.wo, active)
        value = self.eval(ctx, si, bs.wo, active)
        return bs, dr.select(bs.pdf > 0, value / dr.select(bs.pdf > 0, bs.pdf, 1.0), 0.0)

    def eval_diffuse_reflectance(self, si: Any, active: Any = True) -> Any:
        """Albedo of the diffuse part."""
        return self.diffuse.eval(si, active)

    def _peak(self, si: Any, wo: Any) -> Any:
        cosine = dr.dot(mi.reflect(si.wi), wo)
        return dr.select(cosine > 0, dr.power(dr.maximum(cosine, 1e-30), self.exponent), 0.0)

    def _share(self, ctx: Any) -> Any:
        """Share of the samples that the glossy part takes."""
        if not ctx.is_enabled(mi.BSDFFlags.DiffuseReflection, DIFFUSE):
            return mi.Float(1.0)
        return self.glossy_share if ctx.is_enabled(mi.BSDFFlags.GlossyReflection, GLOSSY) else mi.Float(0.0)

    @staticmethod
    def _any(ctx: Any) -> float:
        """0 where the context asks for a part that the BSDF does not have."""
        glossy = ctx.is_enabled(mi.BSDFFlags.GlossyReflection, GLOSSY)
        return float(glossy or ctx.is_enabled(mi.BSDFFlags.DiffuseReflection, DIFFUSE))

    def traverse(self, callback: Any) -> None:
        """Expose the textures and the exponent."""
        callback.put("diffuse_reflectance", self.diffuse, mi.ParamFlags.Differentiable)
        callback.put("specular_reflectance", self.specular, mi.ParamFlags.Differentiable)
        callback.put("exponent", self.exponent, mi.ParamFlags.Differentiable)

    def to_string(self) -> str:
        """Name the plugin and its parameters."""
        return (
            f"Phong[\n  diffuse_reflectance = {self.diffuse},\n  specular_reflectance = {self.specular},\n"
            f"  exponent = {self.exponent}\n]"
        )


mi.register_bsdf("phong", Phong)
