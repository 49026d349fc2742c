"""Who runs beside the main estimator: `volpath` without surfaces, and the main estimator itself without shadows."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.estimators import Equiangular, Volpath
from reference.film_volpath import REFLECTANCES, set_to_zero
from reference.integrator import SingleScattering, mi
from scenes.model import Scene


class AirlightVolpath(Volpath):
    """`volpath` before black surfaces: what it estimates is the airlight, as the main estimator's `scattering` is.

    Light from surfaces would be noise that the other does not have. The surfaces of all that is instantiated from the
    same loaded scene become black with it, for good; the airlight is the same.
    """

    def __init__(self, scene: Scene, samples: int) -> None:
        super().__init__(scene, samples)
        set_to_zero(self.mitsuba.scene, REFLECTANCES)


class Unshadowed(SingleScattering):
    """The integrator without shadow rays (:monosp:`single_scattering_no_shadow_rays`): the time and error left."""

    def _leg(self, scene: Any, ds: Any, margin: float, bounded: bool, in_fog: Any, active: Any) -> tuple[Any, Any]:
        if not bounded:
            return active, self.light_share * ds.dist
        # the length in the fog comes from following the ray, and only the verdict can be left out
        return active, super()._leg(scene, ds, margin, bounded, in_fog, active)[1]


mi.register_integrator("single_scattering_no_shadow_rays", Unshadowed)


def unshadowed(estimator: Equiangular, scene: Scene) -> Equiangular:
    """The same estimator of the same scene, of as many strata for each pixel, without shadow rays."""
    other = with_strata(scene, estimator.samples)
    other.integrator = mi.load_dict({"type": "single_scattering_no_shadow_rays"})
    return other


def with_strata(scene: Scene, strata: NDArray[np.uint32]) -> Equiangular:
    """The main estimator with strata that are chosen, (H, W), not planned."""
    estimator = Equiangular(scene)
    estimator.samples = strata
    return estimator
