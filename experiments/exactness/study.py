"""Two controls against the reference: `exact` has the shadow map's error alone, `given` none."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from experiments.provenance import describe_frame, describe_reference, describe_scene
from experiments.renderers import open_renderer
from gpu_impl.passes.shadow_map import tile_count
from gpu_impl.recording import Pieces
from gpu_impl.techniques import find_technique
from reference.agreement.comparison import Comparison, compare
from reference.agreement.measured import witness
from reference.agreement.unseen import Unseen, unseen_variance
from reference.estimate import Reference, deterministic_reference, estimate_reference
from reference.goal import Goal
from reference.moments import tiles
from scenes.loader import load
from scenes.model import Scene

EXACT, GIVEN = "exact+quadrature", "given+quadrature"
# Texels on a side of a tile before they double: twice six tiles of 1,344 side by side, or one of 8,192, are as wide as
# llvmpipe lets a texture be, or nearly (16,384).
CUBE, FLAT = 1344, 8192
# Doubling leaves half of all borders between texels where they are: one that lies within a quarter of a texel of a
# shadow's edge stays the nearest, and tells it in the same wrong place twice. A map with so small a part of its texels
# less has its borders elsewhere, and is as coarse.
LESS = 1 / 256
# of a pixel's lit length: whether the map's doubling still changes it
STABLE = 1e-3
# what is asked of stable pixels, and of how many of them; and how many pixels have to be stable
PIXEL_LIMIT, PIXELS, SHARE = 2e-3, 0.99, 0.5
MEAN_LIMIT = 1e-3
# the sampled reference that `given` is held against, which shares no ray with it
GOAL = Goal(rel_error=0.01, time_limit=120.0)


@dataclass(frozen=True, eq=False)
class Stable:
    """Pixels that the map's resolution no longer decides, among those with airlight.

    Attributes
    ----------
    share : float     how many there are
    within : float    how many of them are within `PIXEL_LIMIT` of the reference
    """

    share: float
    within: float

    @classmethod
    def among(cls, change: NDArray[np.float64], error: NDArray[np.float64]) -> Stable:
        """Of the pixels with airlight, relative change and error, (n,) each."""
        stable = change < STABLE
        return cls(float(stable.mean()), float((error[stable] <= PIXEL_LIMIT).mean()) if stable.any() else 1.0)

    @property
    def passes(self) -> bool:
        """Whether enough pixels are stable, and enough of them right."""
        return self.share >= SHARE and self.within >= PIXELS


@dataclass(frozen=True, eq=False)
class Case:
    """One scene.

    Attributes
    ----------
    scene : str
    shadow_map : int             texels on a side of a tile; before, half as many
    image_mean : float           relative error of `exact`
    doubled, moved : Stable      where doubling changes nothing, and where doubling a map of `LESS` texels less does not
    given : Comparison           with the sampled reference
    reads, milliseconds : float  of `exact` with `shadow_map` texels: a ray's reads of the map and its pyramid, and a
                                 frame [ms]
    told : dict                  provenance
    """

    scene: str
    shadow_map: int
    image_mean: float
    doubled: Stable
    moved: Stable
    given: Comparison
    reads: float
    milliseconds: float
    told: dict[str, str]

    @property
    def unbiased(self) -> bool:
        """Whether the image's mean is right."""
        return abs(self.image_mean) <= MEAN_LIMIT


def study(
    scenes: Sequence[str], size: tuple[int, int], shadow_map: int | None, tell: Callable[[str], None]
) -> Iterator[Case]:
    """Draw each scene with both controls.

    Parameters
    ----------
    shadow_map : int or None    texels before they double, in place of `CUBE` and `FLAT`
    tell : callable             told what is being done

    Raises
    ------
    InputError
        A scene cannot be used, or its map is wider than OpenGL allows; there is no usable LLVM for the references.
    """
    for scene in [load(name, size=size) for name in scenes]:
        tell(f"{scene.name}: references")
        truth, sampled = deterministic_reference(scene), estimate_reference(scene, GOAL)
        tell(f"{scene.name}: exact and given")
        yield _case(scene, truth, sampled, shadow_map or doubled_map(scene))


def doubled_map(scene: Scene) -> int:
    """Texels of a tile before they double."""
    return CUBE if any(tile_count(light) > 1 for light in scene.lights) else FLAT


def lit_length(lights: Sequence[Pieces]) -> NDArray[np.float64]:
    """How much of each cell's ray is lit, all lights added up, (h * w,) [scene unit]."""
    found = [np.bincount(one.cell, weights=one.dt, minlength=one.start.size) for one in lights]
    return np.sum(found, axis=0)


def against_reference(
    scene: Scene, sampled: Reference, picture: NDArray[np.floating], truth: Reference, name: str
) -> Comparison:
    """Compare airlight (H, W, 3) of given intervals with a sampled reference, by pixels, tiles and the image's mean.

    The intervals are those of `truth`, the deterministic reference, and as far off as it says: where a piece is a
    thousandth of the ray, float32's rounding of the ray's end is more of it than the samples' noise.
    """
    estimate = sampled.estimate
    unseen = unseen_variance(Unseen(scene).equiangular, estimate.samples * estimate.passes)
    image = picture.astype(np.float64)
    drawn = replace(
        truth.estimate,
        mean={"scattering": image},
        tile_mean={"scattering": tiles(image)},
        image_mean={"scattering": image.mean(axis=(0, 1))},
    )
    return compare(witness(name, drawn), witness("reference", estimate, unseen))


def _case(scene: Scene, truth: Reference, sampled: Reference, before: int) -> Case:
    expected = truth.scattering.astype(np.float64)
    bright = expected.max(axis=-1)
    lit = bright > 0

    def error(picture: NDArray[np.floating]) -> NDArray[np.float64]:
        return np.abs(picture - expected).max(axis=-1)[lit] / bright[lit]

    fine, *coarse = (
        find_technique(EXACT, shadow_map=size) for size in (2 * before, before, round((1 - LESS) * before))
    )
    with open_renderer(scene) as renderer:
        frame, given = (renderer.render(technique) for technique in (fine, find_technique(GIVEN)))
        length, *lengths = (lit_length(renderer.record(technique))[lit.ravel()] for technique in (fine, *coarse))
        reads = float(renderer.counts(fine)["shadow_map_reads"].mean())
        milliseconds = renderer.milliseconds(fine, frames=3)

    def change(before: NDArray[np.float64]) -> NDArray[np.float64]:
        longer = np.maximum(before, length)
        # a ray that both find dark does not change
        return np.abs(length - before) / np.where(longer > 0, longer, 1.0)

    doubled, moved = (Stable.among(change(one), error(frame.scattering)) for one in lengths)
    return Case(
        scene.name,
        2 * before,
        frame.scattering.mean(dtype=np.float64) / expected.mean() - 1,
        doubled,
        moved,
        against_reference(scene, sampled, given.scattering, truth, GIVEN),
        reads,
        milliseconds,
        {**describe_scene(scene), **describe_frame(frame), **describe_reference(sampled)},
    )
