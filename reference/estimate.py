"""The reference of a scene: from the cache, or estimated once and kept there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields, replace
from importlib.metadata import version
from typing import Any

import numpy as np

from reference import cache
from reference.checks.shut_in import check_scene
from reference.checks.why_black import why_black
from reference.checks.why_not_finite import why_not_finite
from reference.convergence import Estimate, Progress, converge, relative_error
from reference.deterministic import Deterministic
from reference.estimators import Equiangular, Estimator, FilmVolpath
from reference.goal import FEWEST_PASSES, Goal, PixelFilter
from reference.integrator import mi
from reference.moments import BlackReferenceError, NotFiniteError
from scenes.errors import InputError
from scenes.model import Scene

LAYERS = ("composite", "scattering", "surface")
_ARRAYS = ("mean", "standard_error", "tile_mean", "tile_error", "image_mean", "image_error")
# To halve the error takes four times the passes, or about twice the strata. So an estimate goes on towards a goal up to
# so much stricter than its plan, or than what it reached; else it begins anew, if the new plan is as much stricter.
STRICTER = 2.0


@dataclass(frozen=True)
class Reference:
    """An estimate with the recipe that made it.

    Attributes
    ----------
    estimate : Estimate
    recipe : dict          all that decides a pass: scene, estimator and version, variant, Mitsuba's version
    goal : Goal            what was asked for
    from_cache : bool      whether nothing had to be computed
    passes_before : int    how many of the estimate's passes were in the cache
    notices : tuple        sentences about the cache: an entry was damaged, or this one could not be kept
    """

    estimate: Estimate
    recipe: dict[str, Any]
    goal: Goal
    from_cache: bool = False
    passes_before: int = 0
    notices: tuple[str, ...] = ()

    @property
    def pixel_filter(self) -> str:
        """Whether its rays go through pixel centres, "centre", or all over the pixels, "box"."""
        return str(self.recipe["pixel_filter"])

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

    def noise(self, layer: str) -> np.ndarray | None:
        """Standard error of what was sampled, (H, W, 3); None of a deterministic reference, which has no noise."""
        return None if self.estimate.stopped_by == "exact" else self.standard_error(layer)

    @property
    def layers(self) -> dict[str, np.ndarray]:
        """Every array by the name that its layer has in an EXR file; errors as "standard_error.scattering"."""
        errors = {f"standard_error.{layer}": self.standard_error(layer) for layer in LAYERS}
        return {layer: getattr(self, layer) for layer in LAYERS} | errors

    def __repr__(self) -> str:
        """One line, for notebooks."""
        height, width = self.surface.shape[:2]
        estimate = self.estimate
        if not estimate.passes:
            return f"<Reference {width} x {height}, deterministic, relative error {estimate.rel_error:.1e}>"
        limit = "" if estimate.reached else f", stopped ({estimate.stopped_by})"
        return (
            f"<Reference {width} x {height}, relative standard error {estimate.rel_error:.2%} after "
            f"{estimate.passes} passes{limit}>"
        )


def estimate_reference(
    scene: Scene,
    goal: Goal,
    report: Callable[[Progress], None] | None = None,
    pixel_filter: PixelFilter = "centre",
) -> Reference:
    """Take the scene's reference from the cache, go on with the one there, or estimate it; and keep it there.

    An entry holds for every goal that it meets. One that was stopped, by a limit, by Ctrl-C or by a kill, goes on where
    it was.

    Parameters
    ----------
    report : called after each pass, for a progress bar
    pixel_filter : "centre" or "box"; without a usable LLVM it is always the box

    Raises
    ------
    InputError
        The scene cannot be estimated, the estimate is zero everywhere or not finite, or the cache's folder cannot be
        written. Where only its disk is full, which shows after the work, the reference is returned all the same and
        says so.
    """
    if mi.variant() == "scalar_rgb":
        pixel_filter = "box"
    estimator = FilmVolpath if mi.variant() == "scalar_rgb" else Equiangular
    entry = _Entry(scene, _recipe(scene, estimator, pixel_filter), goal)
    start = entry.load()
    if start and _meets(start, goal):
        start = replace(start, rel_error=_rel_error(start, goal), stopped_by="goal")
        return entry.reference(start, from_cache=True, passes_before=start.passes)
    entry.check()
    made: Estimator = FilmVolpath(scene) if estimator is FilmVolpath else Equiangular(scene, pixel_filter=pixel_filter)
    with _explained(scene):
        before = start
        if (
            start
            and STRICTER * goal.rel_error < min(start.planned_for, _rel_error(start, goal))
            # a limit that had no room for the strata may have none again
            and STRICTER * made.plan(goal) <= start.planned_for
        ):
            start = None
        estimate = converge(made, goal, report, start, entry.keep)
    entry.keep(estimate)
    if before and not start and _rel_error(before, goal) < _rel_error(estimate, goal):
        # what begins anew may be stopped before it is as good
        stopped = replace(before, rel_error=_rel_error(before, goal), stopped_by=estimate.stopped_by)
        return entry.reference(stopped, passes_before=before.passes)
    return entry.reference(estimate, passes_before=start.passes if start else 0)


def deterministic_reference(scene: Scene) -> Reference:
    """Take the scene's reference without Monte Carlo from the cache, or compute it and keep it there.

    Its errors are numerical ones; see `reference.deterministic`.

    Raises
    ------
    InputError
        As `estimate_reference`; or there is no usable LLVM, without which rays are too slow.
    """
    entry = _Entry(scene, _recipe(scene, Deterministic, "centre"))
    if found := entry.load():
        return entry.reference(found, from_cache=True)
    entry.check()
    with _explained(scene):
        estimate = Deterministic(scene).estimate()
    entry.keep(estimate)
    return entry.reference(estimate)


class _Entry:
    """A reference's place in the cache, and what is to be said of it."""

    def __init__(self, scene: Scene, recipe: dict[str, Any], goal: Goal | None = None) -> None:
        self._scene, self._recipe, self._goal = scene, recipe, goal
        self._damaged: list[str] = []
        self._not_kept: list[str] = []
        self._is_another = False

    def load(self) -> Estimate | None:
        if not (entry := cache.load(self._recipe, self._damaged.append)):
            return None
        try:
            return _unpack(*entry)
        except (KeyError, TypeError):
            # whole, and by somebody else
            self._is_another = True
            self._damaged.append("An entry of the cache holds no reference; it is estimated again.")
            return None

    def check(self) -> None:
        """Refuse what would fail: better before the work than after it."""
        cache.check_writable()
        check_scene(self._scene)

    def keep(self, estimate: Estimate) -> None:
        """Keep it, unless what is there is better: begun anew towards a stricter goal, or made by another program."""
        there = None if self._is_another else cache.load_record(self._recipe)
        if there and not _takes_the_place(estimate, there):
            return
        self._is_another = False
        arrays, numbers = _pack(estimate)
        told = {"scene_name": self._scene.name, "parameters": self._scene.parameters}
        if self._goal:
            told["goal"] = asdict(self._goal)
        self._not_kept.clear()
        try:
            cache.store(self._recipe, arrays, numbers | told)
        except InputError as error:
            # a full disk is no reason to stop
            self._not_kept.append(f"The reference is not kept for the next time: {error}")

    def reference(self, estimate: Estimate, from_cache: bool = False, passes_before: int = 0) -> Reference:
        notices = (*self._damaged, *self._not_kept)
        return Reference(estimate, self._recipe, self._goal or Goal(), from_cache, passes_before, notices)


def _takes_the_place(estimate: Estimate, there: dict[str, Any]) -> bool:
    """Tell whether an estimate is to replace the one of a record: it is more of the same, or more accurate."""
    same_plan = estimate.planned_for == there["planned_for"]
    if same_plan and estimate.passes >= there["passes"]:
        return True
    known = estimate.passes >= min(FEWEST_PASSES, there["passes"])
    return known and _rel_error(estimate, Goal(**there["goal"])) < there["rel_error"]


@contextmanager
def _explained(scene: Scene) -> Iterator[None]:
    """Say what of the scene makes its reference black or infinite."""
    try:
        yield
    except BlackReferenceError as error:
        raise InputError(f"{error} {why_black(scene)}") from None
    except NotFiniteError as error:
        raise InputError(why_not_finite(scene, error.layer, error.image)) from None


def _recipe(
    scene: Scene, estimator: type[Equiangular | FilmVolpath | Deterministic], pixel_filter: PixelFilter
) -> dict[str, Any]:
    return {
        "scene": scene.digest,
        "size": [scene.camera.width, scene.camera.height],
        "estimator": estimator.name,
        "estimator_version": estimator.version,
        "pixel_filter": pixel_filter,
        "variant": mi.variant(),
        "mitsuba": version("mitsuba"),
        "drjit": version("drjit"),
    }


def _rel_error(estimate: Estimate, goal: Goal) -> float:
    """Of the layer that decides; see `Estimator.layers`."""
    return relative_error(estimate.mean["scattering"], estimate.standard_error["scattering"], goal.percentile)


def _meets(estimate: Estimate, goal: Goal) -> bool:
    return estimate.passes >= FEWEST_PASSES and _rel_error(estimate, goal) <= goal.rel_error


def _pack(estimate: Estimate) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    arrays = {f"{kind}.{layer}": image for kind in _ARRAYS for layer, image in getattr(estimate, kind).items()}
    numbers = {
        field.name: getattr(estimate, field.name)
        for field in fields(Estimate)
        if field.name not in (*_ARRAYS, "samples")
    }
    return arrays | {"samples": estimate.samples}, numbers | {"finished": estimate.reached}


def _unpack(arrays: dict[str, np.ndarray], record: dict[str, Any]) -> Estimate:
    layers: dict[str, dict[str, np.ndarray]] = {kind: {} for kind in _ARRAYS}
    for name, image in arrays.items():
        kind, _, layer = name.partition(".")
        if layer:
            layers[kind][layer] = image
    numbers = {field.name: record[field.name] for field in fields(Estimate) if field.name in record}
    return Estimate(**layers, samples=arrays["samples"], **numbers)  # type: ignore[arg-type]
