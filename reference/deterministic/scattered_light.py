"""What one light sends to the eye by way of each place of a ray, per unit of length; from the loaded scene, in float64.

Nothing of the integrator is used, so that a mistake in either shows as a difference.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from analytic.segments import half_angle
from reference.deterministic.ray_spans import Array, Rays, chord
from reference.deterministic.spot_picture import looked_up
from scenes.model import Light, Scene


class ScatteredLight:
    """Single scattering of one light.

    Parameters
    ----------
    scene : Scene
    light : Light               one of the scene's
    light_share : float         of the way to the light, from the ray on, over which its light is attenuated
    parallel_way : callable     points (..., 3) to the way of a directional light that the share is of (...)

    Attributes
    ----------
    whole_leg_in_fog : bool     the light is in the fog, so that all its ways to places in the fog are
    """

    def __init__(self, scene: Scene, light: Light, light_share: float, parallel_way: Callable[[Array], Array]) -> None:
        self._medium, self._phase, self._boundary = scene.medium, scene.phase, scene.boundary
        self._light, self._share, self._parallel_way = light, light_share, parallel_way
        self._parallel = light.kind == "directional"
        self.whole_leg_in_fog = not self._parallel and (
            scene.boundary is None or bool(scene.boundary.contains(light.position))
        )

    def density(self, rays: Rays, t: Array) -> Array:
        """Radiance per unit of length that reaches the eye from places of rays.

        Parameters
        ----------
        rays : Rays      (n,)
        t : (n, m)       places in the fog [scene unit]

        Returns
        -------
        ndarray, (n, m, 3)
        """
        point = rays.origin[:, None] + t[..., None] * rays.direction[:, None]
        if self._parallel:
            cosine = -np.clip(rays.direction @ self._light.direction, -1, 1)
            strength = self._phase.evaluate(cosine)[:, None]
            to_light, d = np.broadcast_to(-self._light.direction, point.shape), self._parallel_way(point)
        else:
            h, t_h = rays.beside(self._light)
            s = t - t_h[:, None]
            d = np.hypot(h[:, None], s)
            strength = self._phase.of_half_angle(*half_angle(h[:, None], s, d)) / (d * d)
            to_light = (self._light.position - point) / d[..., None]
        way = (t - rays.fog_begin[:, None] + self._leg(point, to_light, d))[..., None]
        power = self._light.intensity * np.broadcast_to(self._medium.sigma_s, 3)
        return (
            np.exp(-np.broadcast_to(self._medium.sigma_t, 3) * way) * strength[..., None] * power * self.angular(point)
        )

    def uniform(self, rays: Rays, t: Array) -> NDArray[np.bool_]:
        """Whether `analytic` has the airlight around places t of rays, (n,) each: no rim, picture or boundary; (n,)."""
        if not self.whole_leg_in_fog or self._share != 1 or self._light.texture is not None:
            return np.zeros(t.size, np.bool_)
        return self.falloff(rays.origin + t[:, None] * rays.direction) == 1

    def angular(self, point: Array) -> Array:
        """What of the light's intensity goes towards points (..., 3), (..., 1 or 3)."""
        share = self.falloff(point)[..., None]
        if self._light.texture is None:
            return share
        local = (point - self._light.position) @ np.linalg.inv(self._light.to_world[:3, :3]).T
        # the picture fills the square around the cone
        with np.errstate(divide="ignore", invalid="ignore"):
            uv = 0.5 + 0.5 * local[..., :2] / (local[..., 2:] * np.tan(self._light.cutoff_angle))
        return share * looked_up(self._light.texture, np.where(share > 0, uv, 0.5))

    def falloff(self, point: Array) -> Array:
        """Mitsuba's falloff of a spot towards points (..., 3), linear in the angle, 1 to 0; (...)."""
        beam, cutoff = self._light.beam_width, self._light.cutoff_angle
        if beam == cutoff:
            # no spot, or one that the intervals leave only the inside of
            return np.ones(point.shape[:-1])
        axis, from_light = self._light.direction, point - self._light.position
        angle = np.arctan2(np.linalg.norm(np.cross(axis, from_light), axis=-1), from_light @ axis)
        return np.clip((cutoff - angle) / (cutoff - beam), 0, 1)

    def _leg(self, point: Array, to_light: Array, d: Array) -> Array:
        """How much of the light's way to points is attenuated, (...) [scene unit]."""
        if self._boundary is None or self.whole_leg_in_fog:
            return self._share * d
        _, leave = chord(self._boundary, point, to_light)
        return np.clip(leave, 0, self._share * d)
