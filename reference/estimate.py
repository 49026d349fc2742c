"""The reference of a scene: from the cache, or estimated once and kept there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
from importlib.metadata import version
from typing import Any

import numpy as np

from reference import cache
from reference.convergence import Estimate, Progress, converge
from reference.estimators import Equiangular, FilmVolpath, default_estimator
from reference.goal import Goal
from reference.integrator import mi
from scenes.errors import InputError
from scenes.model import Scene

LAYERS = ("composite", "scattering", "surface")
_ARRAYS = ("mean", "standard_error", "image_mean", "image_error")


@dataclass(frozen=True)
class Reference:
    """An estimate with the recipe that made it.

    Attributes
    ----------
    estimate : Estimate
    recipe : dict          all that decides it: scene, estimator and version, variant, goal, Mitsuba's version
    pixel_filter : str     "centre" or "box"
    from_cache : bool
    not_kept : str         why it could not be kept in the cache; empty where it is there
    """

    estimate: Estimate
    recipe: dict[str, Any]
    pixel_filter: str
    from_cache: bool
    not_kept: str = ""

    @property
    def scene_digest(self) -> str:
        """Which scene it is the reference of; see `scenes.model.Scene`."""
        return str(self.recipe["scene"])

    @property
    def surface(self) -> np.ndarray:
        """Light from surfaces, (H, W, 3)."""
        return self.estimate.mean["surface"]

    @property
    def scattering(self) -> np.ndarray:
        """Airlight, (H, W, 3)."""
        return self.estimate.mean["scattering"]

    @property
    def composite(self) -> np.ndarray:
        """Both together, (H, W, 3)."""
        return self.surface + self.scattering

    def standard_error(self, layer: str) -> np.ndarray:
        """Standard error of "surface", "scattering" or "composite", (H, W, 3)."""
        if layer == "composite":
            return np.hypot(self.standard_error("surface"), self.standard_error("scattering"))
        return self.estimate.standard_error[layer]

    @property
    def layers(self) -> dict[str, np.ndarray]:
        """Every array by the name that its layer has in an EXR file; errors as "standard_error.scattering"."""
        errors = {f"standard_error.{layer}": self.standard_error(layer) for layer in LAYERS}
        return {layer: getattr(self, layer) for layer in LAYERS} | errors

    def __repr__(self) -> str:
        """One line, for notebooks."""
        height, width = self.surface.shape[:2]
        estimate = self.estimate
        return (
            f"<Reference {width} x {height}, relative standard error {estimate.rel_error:.2%} after "
            f"{estimate.passes} passes{'' if estimate.reached else ', out of time'}>"
        )


def estimate_reference(scene: Scene, goal: Goal, report: Callable[[Progress], None] | None = None) -> Reference:
    """Take the scene's reference from the cache, or estimate it and keep it there.

    Parameters
    ----------
    report : called after each pass, for a progress bar

    Raises
    ------
    InputError
        The estimate is zero everywhere or not finite, or the cache's folder cannot be written. Where only its disk is
        full, which shows after the work, the reference is returned all the same and says so.
    """
    # the class says all that a cached reference has to agree with; Mitsuba's scene is made only for a new one
    estimator = default_estimator()
    recipe = _recipe(scene, estimator, goal)
    if entry := cache.load(recipe):
        return Reference(_unpack(*entry), recipe, estimator.pixel_filter, from_cache=True)
    cache.check_writable()
    estimate = converge(estimator(scene), goal, report)
    not_kept = ""
    try:
        cache.store(recipe, *_pack(estimate))
    except InputError as error:
        not_kept = str(error)
    return Reference(estimate, recipe, estimator.pixel_filter, from_cache=False, not_kept=not_kept)


def _recipe(scene: Scene, estimator: type[Equiangular] | type[FilmVolpath], goal: Goal) -> dict[str, Any]:
    return {
        "scene": scene.digest,
        "size": [scene.camera.width, scene.camera.height],
        "estimator": estimator.name,
        "estimator_version": estimator.version,
        "samples_per_pass": estimator.samples_per_pass,
        "variant": mi.variant(),
        "mitsuba": version("mitsuba"),
        "drjit": version("drjit"),
        "goal": asdict(goal),
    }


def _pack(estimate: Estimate) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    arrays = {f"{kind}.{layer}": image for kind in _ARRAYS for layer, image in getattr(estimate, kind).items()}
    return arrays, {
        field.name: getattr(estimate, field.name) for field in fields(Estimate) if field.name not in _ARRAYS
    }


def _unpack(arrays: dict[str, np.ndarray], record: dict[str, Any]) -> Estimate:
    layers: dict[str, dict[str, np.ndarray]] = {kind: {} for kind in _ARRAYS}
    for name, image in arrays.items():
        kind, layer = name.split(".")
        layers[kind][layer] = image
    numbers = {field.name: record[field.name] for field in fields(Estimate) if field.name not in _ARRAYS}
    return Estimate(**layers, **numbers)  # type: ignore[arg-type]
