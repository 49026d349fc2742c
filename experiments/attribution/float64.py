"""Airlight of the pieces that a technique reported, evaluated in float64: what it would draw without rounding.

Each airlight model has a twin: `analytic` has the closed forms and tables under the shader's name. For `quadrature` it
is the integral itself, so that what the shader's rule leaves counts as rounding too (5e-7, see
`analytic.models.quadrature_float32`, and up to 2e-4 of the brightest pixel where it meets the kink at a soft spot's
beam). For `riemann` it is the point sample, for `depth_fog` the fog whose source is that at the eye's place; these
three take any light and any body of fog, by the reference's float64 density.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from analytic import MODELS, airlight
from analytic.models.depth_fog import depth_fog
from analytic.phase import Phase
from reference.deterministic.kinks import Stretches
from reference.deterministic.piece_airlight import piece_airlight
from reference.deterministic.ray_spans import Array, Rays
from reference.deterministic.scattered_light import ScatteredLight
from scenes.model import Light, Scene

# pieces at once: the quadrature holds some hundred numbers of each
CHUNK = 1 << 16


@dataclass(frozen=True, eq=False)
class Pieces:
    """Lit pieces of rays, (n,) each, in any order.

    Attributes
    ----------
    ray : int          index of the ray
    begin : float64    along the ray as `Camera.rays` has it [scene unit]
    length : float64   [scene unit]
    weight : float64   how much of it is lit, of either sign
    """

    ray: NDArray[np.intp]
    begin: Array
    length: Array
    weight: Array

    def __len__(self) -> int:
        return self.ray.size

    def chunks(self) -> Iterator[Pieces]:
        """All of them, `CHUNK` at a time."""
        for first in range(0, len(self), CHUNK):
            yield Pieces(*(getattr(self, part.name)[first : first + CHUNK] for part in fields(self)))

    def in_steps(self, rays: Rays, steps: int) -> Pieces:
        """Cut into equal parts no longer than one of so many steps over the ray; see shaders/scattering.frag.glsl."""
        whole = (rays.fog_end - rays.fog_begin)[self.ray]
        # the shader's allowance for rounding
        parts = np.maximum(np.ceil(self.length * steps / whole - 0.01), 1).astype(np.intp)
        owner, length = np.repeat(np.arange(len(self)), parts), self.length / parts
        number = np.arange(owner.size) - (np.cumsum(parts) - parts)[owner]
        begin = self.begin[owner] + number * length[owner]
        return Pieces(self.ray[owner], begin, length[owner], self.weight[owner])


def why_no_twin(model: str, phase: Phase) -> str:
    """The reason why a shader's airlight model cannot be evaluated in float64; empty where it can."""
    if model == "weng2010:printed" and phase.name == "rayleigh":
        # chapter 5 prints Rayleigh's function 4 pi times too large, and the shader has it so
        return "the shader has the phase function of chapter 5 as printed, and its float64 twin the normalised one"
    return "" if model in (*_DENSITIES, *MODELS) else f"`{model}` has no float64 twin in analytic.MODELS"


def airlight_of_pieces(scene: Scene, light: Light, model: str, rays: Rays, pieces: Pieces) -> Array:
    """Airlight of one light, summed over the pieces of each ray.

    Parameters
    ----------
    light : Light     one of the scene's
    model : str       one of `gpu_impl.airlight_models`, for which `why_no_twin` has no reason
    rays : Rays       their fog begins where the eye's leg does, and ends where the technique has it end
    pieces : Pieces   of those rays; where the model takes the light as even, inside its cone

    Returns
    -------
    ndarray, (rays, 3)    [radiance]
    """
    scattered = ScatteredLight(scene, light, 1.0, _whole_way)
    evaluate = _DENSITIES.get(model) or _closed_form(model)
    total = np.zeros((len(rays), 3))
    for some in pieces.chunks():
        np.add.at(total, some.ray, some.weight[:, None] * evaluate(scene, light, scattered, rays[some.ray], some))
    return total


# scene, light, its scattered light, the ray of each piece, pieces -> (n, 3)
Evaluate = Callable[[Scene, Light, ScatteredLight, Rays, Pieces], Array]


def _whole_way(point: Array) -> Array:
    """Parallel light comes from infinitely far: the fog's boundary decides."""
    return np.full(point.shape[:-1], np.inf)


def _quadrature(scene: Scene, light: Light, scattered: ScatteredLight, rays: Rays, pieces: Pieces) -> Array:
    # every piece a ray of its own, so that it keeps its weight
    own = Stretches(np.arange(len(pieces)), pieces.begin, pieces.begin + pieces.length)
    return piece_airlight(scene, light, scattered, rays, own)[0]


def _point_sample(scene: Scene, light: Light, scattered: ScatteredLight, rays: Rays, pieces: Pieces) -> Array:
    middle = pieces.begin + 0.5 * pieces.length
    sample = scattered.density(rays, middle[:, None])[:, 0] * pieces.length[:, None]
    if light.kind == "spot" and light.beam_width == light.cutoff_angle:
        # the reference clips its intervals to a hard cone, and its density does not ask
        away = rays.origin + middle[:, None] * rays.direction - light.position
        across = np.linalg.norm(np.cross(light.direction, away), axis=-1)
        sample[np.arctan2(across, away @ light.direction) > light.cutoff_angle] = 0
    return sample


def _depth_fog(scene: Scene, light: Light, scattered: ScatteredLight, rays: Rays, pieces: Pieces) -> Array:
    # a spot's intensity in each direction does not count, and its cone has cut the pieces
    even = replace(light, beam_width=light.cutoff_angle, texture=None)
    at_eye = ScatteredLight(scene, even, 1.0, _whole_way).density(rays, rays.fog_begin[:, None])[:, 0]
    begin = (pieces.begin - rays.fog_begin)[:, None]
    return depth_fog(at_eye, np.broadcast_to(scene.medium.sigma_t, 3), begin, pieces.length[:, None])


def _closed_form(model: str) -> Evaluate:
    def evaluate(scene: Scene, light: Light, scattered: ScatteredLight, rays: Rays, pieces: Pieces) -> Array:
        h, t_h = rays.beside(light)
        end = pieces.begin + pieces.length
        unit = airlight(h, pieces.begin - t_h, end - t_h, scene.medium, scene.phase, model=model)
        # a closed form takes the light as even over the piece, as bright as in its middle
        share = scattered.angular(rays.origin + (0.5 * (pieces.begin + end))[:, None] * rays.direction)
        eye = np.exp(-np.multiply.outer(pieces.begin - rays.fog_begin, np.broadcast_to(scene.medium.sigma_t, 3)))
        return eye * light.intensity * share * unit.reshape(len(pieces), -1)

    return evaluate


_DENSITIES: dict[str, Evaluate] = {"quadrature": _quadrature, "riemann": _point_sample, "depth_fog": _depth_fog}
