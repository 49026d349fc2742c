"""What a finite number of samples may not have met.

A shadow, or a gap in one, of which a sample's chance is q is missed by n samples with the probability e^(-q n). It then
leaves no trace in their spread, and the mean is off by q times what a sample there would have brought, f at most. An
error of k f / n covers that at every level of significance up to the critical score z of the test: e^(-q n) is the
tail beyond the score z where q n = -log(tail), and k is that over z, 3.2 for the 12,288 numbers of 64 x 64 pixels.
Without it a shadow so short that no sample met it is a disagreement: of 4,096 pixels of `sphere` 5 were beyond 4 error
bars after 97 passes of 16 samples, the worst at 50, and none after 1,600.

The deterministic mode's probes are n even steps apart. A shadow, or a gap in one, that none of them met is shorter
than a step: q < 1 / n for certain, and the mean is off by less than f / n, f the brightest place of the ray in the
variable in which the steps are even. That is k = 1. It bounds what one such feature can do, so as a standard error it
covers as many of one sign as the critical score, five or so. With 4,096 steps, half of what it begins with, it
is 5e-5 of the median pixel on `yeahright` and `many_objects`, 1.6e-4 on `wire_mesh`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.agreement.significance import SIGNIFICANCE, critical_score
from reference.agreement.volpath import AsVolpath
from reference.distances import equiangular_or_attenuated, even_or_attenuated, position_of, reach
from reference.estimators import Equiangular
from reference.fog_path import FogPath, fog_of
from reference.integrator import delta_emitters, eye_path, mi
from reference.moments import Image
from scenes.model import Scene

# isort: split
import drjit as dr  # after the integrator, which chose Dr.Jit's LLVM

# places of a ray at which it is looked how bright a sample may be, even in the variable that the estimator samples
PLACES = 64


class Unshadowed(AsVolpath):
    """Nothing in the way (:monosp:`single_scattering_unshadowed`)."""

    def _leg(self, *arguments: Any) -> tuple[Any, Any]:
        return arguments[-1], super()._leg(*arguments)[1]


class Even(Unshadowed):
    """Distances as the probes of the deterministic mode stand (:monosp:`single_scattering_even`).

    At even steps of the angle at which a light sees them, or of the distance for parallel light, however thick the fog.
    """

    def _distances(self, scene: Any, emitter: Any, ray: Any, path: FogPath, medium: Any) -> Any:
        begin, end = (dr.clip(t, path.fog_begin, path.fog_end) for t in reach(emitter, ray, path.fog_end))
        if mi.has_flag(emitter.flags(), mi.EmitterFlags.DeltaPosition):
            return equiangular_or_attenuated(ray, begin, end, position_of(emitter, ray), 0.0)
        return even_or_attenuated(begin, end, 0.0)


class Unabsorbed(Unshadowed):
    """Nothing lost on the light's leg either (:monosp:`single_scattering_unabsorbed`).

    On that leg `volpath` counts all of the light or none of it, with the transmittance as the chance.
    """

    def _leg(self, *arguments: Any) -> tuple[Any, Any]:
        return arguments[-1], mi.Float(0.0)

    def surface_leg(self, *arguments: Any) -> tuple[Any, Any]:
        """Keep the visibility alone: volpath's surfaces are where ours are."""
        return super().surface_leg(*arguments)[0], mi.Float(0.0)


mi.register_integrator("single_scattering_unshadowed", Unshadowed)
mi.register_integrator("single_scattering_even", Even)
mi.register_integrator("single_scattering_unabsorbed", Unabsorbed)


class Unseen:
    """Brightest samples of each pixel's ray, were nothing in the way.

    Attributes
    ----------
    equiangular : (H, W, 3)    of the main estimator: the root of the squares' sum over the lights
    even : (H, W, 3)           the same in the deterministic mode's variable
    volpath : (H, W, 3)        the same of volpath, which chooses one light; and over its surface
    has_shadow : bool          whether any place of a ray is in fog that something shades
    has_surface : bool         whether any ray ends at a surface
    """

    def __init__(self, scene: Scene) -> None:
        estimator = Equiangular(scene)
        mitsuba_scene, medium = estimator.mitsuba.scene, estimator.mitsuba.medium
        kinds = ("unshadowed", "even", "unabsorbed", "as_volpath")
        unshadowed, even, unabsorbed, right = (mi.load_dict({"type": f"single_scattering_{kind}"}) for kind in kinds)
        height, width = estimator.shape
        ray = estimator.rays(dr.arange(mi.UInt32, height * width))
        path = eye_path(mitsuba_scene, ray, medium)
        fog = fog_of(mitsuba_scene, medium)
        _, _, sigma_t = fog.get_scattering_coefficients(right._interaction(fog, ray, path.fog_begin))

        def through(length: Any) -> Any:
            # volpath samples the free path of one channel; the least likely of them brings the most
            return dr.maximum(dr.min(right._attenuated(mi.Spectrum(1.0), fog, ray, length)), 1e-30)

        emitters = delta_emitters(mitsuba_scene)
        squares = np.zeros((3, height * width, 3))
        shaded = dr.zeros(mi.Bool, height * width)
        for emitter in emitters:
            towards = (mitsuba_scene, emitter, ray, path, medium)
            distance, probe = unshadowed._distances(*towards), even._distances(*towards)
            brightest = np.zeros((3, height * width, 3))
            for number in range(PLACES):
                u = dr.opaque(mi.Float64, (number + 0.5) / PLACES)
                t, inverse_pdf = distance(u)
                place = (mitsuba_scene, emitter, ray, t, medium)
                open_, free = unshadowed.scattered(*place), unabsorbed.scattered(*place)
                density = dr.maximum(dr.min(sigma_t), 1e-30) * through(t - path.fog_begin)
                shaded |= dr.any((open_ > 0) & (right.scattered(*place) == 0))
                t, inverse_even = probe(u)
                probed = even.scattered(mitsuba_scene, emitter, ray, t, medium) * inverse_even
                samples = [_image(one) for one in (open_ * inverse_pdf, probed, free / density * len(emitters))]
                np.maximum(brightest, samples, out=brightest)
            squares += brightest**2
        surface = unabsorbed.surface(mitsuba_scene, ray, path, medium) / through(path.fog_length) * len(emitters)
        squares[2] += _image(surface) ** 2
        self.equiangular, self.even, self.volpath = np.sqrt(squares).reshape(3, height, width, 3)
        self.has_shadow, self.has_surface = bool(dr.any(shaded)), bool(dr.any(path.blocked))


def _image(radiance: Any) -> Image:
    return np.array(radiance, np.float64).T


def unseen_variance(brightest: Image, samples: NDArray[np.integer] | int) -> Image:
    """Variance of each pixel for what its random samples may not have met, (H, W, 3).

    Parameters
    ----------
    brightest : (H, W, 3)    what a sample may bring
    samples : (H, W) or int  taken of each pixel in all passes
    """
    score = critical_score(brightest.size)
    tail = -np.expm1(np.log1p(-SIGNIFICANCE) / brightest.size)
    count = np.asarray(samples, float)
    return np.square(-np.log(tail) / score * brightest / (count[..., None] if count.ndim else count))


def unprobed_variance(brightest: Image, steps: NDArray[np.integer]) -> Image:
    """Variance of each pixel for what lies between its evenly spaced probes, (H, W, 3).

    Parameters
    ----------
    brightest : (H, W, 3)    `Unseen.even`
    steps : (H, W)           between the probes of each ray
    """
    return np.square(brightest / steps[..., None])
