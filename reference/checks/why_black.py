"""Why the reference of a scene is zero everywhere, found by following its light from the lamp to the eye."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.deterministic.ray_spans import Array, Rays, chord
from reference.deterministic.scattered_light import ScatteredLight
from reference.deterministic.shadow_rays import ShadowRays
from reference.integrator import mi
from scenes.model import Light, Scene

# places that are looked at for each light: so many rays, and so many places on each
RAYS, PLACES = 1024, 32
# float32 holds nothing below e^-87.3 in full, and the reference is estimated in float32
DEEPEST = -float(np.log(np.finfo(np.float32).tiny))


@dataclass(frozen=True)
class _Lit:
    """Places in the fog that a light shines at, surfaces aside.

    Attributes
    ----------
    light : Light
    place : (n, 3)      [scene unit]
    power : (n,)        radiance per scene unit that they send to the camera, without extinction; brightest channel
    depth : (n,)        optical depth of the way from the light to the camera, of the channel in which it is least
    """

    light: Light
    place: Array
    power: Array
    depth: Array

    def __getitem__(self, which: NDArray[np.bool_]) -> _Lit:
        return _Lit(self.light, self.place[which], self.power[which], self.depth[which])


def why_black(scene: Scene) -> str:
    """Say in a sentence why no airlight reaches the camera.

    What is said was found in this scene: the first step on light's way that none of it survives. In `scalar_rgb`, where
    rays are slow, surfaces are what is left when everything else is excluded.
    """
    return f"In {scene.path}, {_of_colours(scene) or _of_the_view(scene) or _of_the_light(scene)}."


def _of_colours(scene: Scene) -> str:
    """Whether what the fog does leaves no light; empty where it leaves some."""
    medium = scene.medium
    if not medium.sigma_t.any():
        return "the fog has sigma_t = 0, so there is none"
    if not medium.sigma_s.any():
        return "the fog has albedo = 0: it absorbs light and scatters none"
    if not any((medium.sigma_s * light.intensity).any() for light in scene.lights):
        return (
            f"the fog scatters (sigma_s = {np.round(medium.sigma_s, 6).tolist()}) in none of the channels in which a "
            "light shines"
        )
    return ""


def _of_the_view(scene: Scene) -> str:
    """Whether the camera sees no fog; empty where it does."""
    rays = Rays.of_camera(scene, scene.camera.rays()[2].ravel())
    if not (rays.fog_end > rays.fog_begin).any():
        return "no ray of the camera meets the shape that holds the fog: turn the camera to it, or move its far plane"
    rays = Rays.of_camera(scene, _t_end(scene))
    if not (rays.fog_end > rays.fog_begin).any():
        return "surfaces stand before the shape that holds the fog, on every ray of the camera"
    return ""


def _of_the_light(scene: Scene) -> str:
    """Which step on its way no light survives, from the lamp on."""
    rays = Rays.of_camera(scene, _t_end(scene))
    places = _kept([_places(scene, light, rays) for light in scene.lights])
    if not places:
        return "no light shines at fog that the camera sees: the cone of every spot points elsewhere"
    places = _kept([lit[lit.power > 0] for lit in places])
    if not places:
        return "what shines at fog that the camera sees is black: the phase function, or the picture of a spot, is 0"
    if not _is_scalar():
        shadows = ShadowRays(scene)
        places = _kept([lit[np.array(shadows.sees(lit.light, lit.place.T))] for lit in places])
        if not places:
            return "surfaces keep every light from the fog that the camera sees"
    depth = np.concatenate([lit.depth for lit in places])
    if (depth > DEEPEST).all():
        return (
            f"the fog lets no light through: the way from a light to the camera has an optical depth of at least "
            f"{depth.min():.4g}, of which float32 holds nothing from {DEEPEST:.1f} on; make sigma_t smaller"
        )
    arriving = np.concatenate([lit.power for lit in places]) * np.exp(-depth)
    if (arriving < np.finfo(np.float32).tiny).all():
        return (
            f"the light is too faint for float32: not more than {arriving.max():.1e} reaches the camera from a scene "
            "unit of fog; make the lights brighter"
        )
    if _is_scalar():
        return "surfaces keep every light from the fog that the camera sees, or from all but the smallest part of it"
    return (
        f"no reason was found: {depth.size} places of the fog that the camera sees are lit; please report this with "
        "the scene"
    )


def _is_scalar() -> bool:
    return mi.variant().startswith("scalar")


def _kept(places: list[_Lit]) -> list[_Lit]:
    """Those of the lights of which there are any."""
    return [lit for lit in places if len(lit.place)]


def _t_end(scene: Scene) -> Array:
    """How far the camera's rays see, (pixels,) [scene unit]; in `scalar_rgb` as if there were no surfaces."""
    return scene.camera.rays()[2].ravel() if _is_scalar() else ShadowRays(scene).t_end()


def _places(scene: Scene, light: Light, rays: Rays) -> _Lit:
    """Places of the fog at which a light shines, on rays evenly chosen among those on which there are any."""
    begin, end = rays.reached_by(light)
    (chosen,) = np.nonzero(end > begin)
    chosen = chosen[:: max(1, len(chosen) // RAYS)]
    share = (np.arange(PLACES) + 0.5) / PLACES
    # closer together near the camera: in thick fog only these may count
    t = begin[chosen, None] + (end - begin)[chosen, None] * share**2
    place = (rays.origin[chosen, None] + t[..., None] * rays.direction[chosen, None]).reshape(-1, 3)
    to_eye = -np.repeat(rays.direction[chosen], PLACES, axis=0)
    medium, source = scene.medium, ScatteredLight(scene, light, 1.0, lambda point: np.zeros(len(point)))
    if light.kind == "directional":
        travel, distance, spread = np.broadcast_to(light.direction, place.shape), np.full(len(place), np.inf), 1.0
    else:
        # nothing is divided by 0 where a place happens to be the light itself
        distance = np.maximum(np.linalg.norm(place - light.position, axis=-1), np.finfo(np.float64).tiny)
        travel, spread = (place - light.position) / distance[:, None], distance**2
    phase = scene.phase.evaluate((travel * to_eye).sum(axis=-1)) / spread
    colour = np.broadcast_to(medium.sigma_s * light.intensity, 3)
    leg = np.minimum(distance, chord(scene.boundary, place, -travel)[1])
    way = (t - rays.fog_begin[chosen, None]).ravel() + leg
    return _Lit(
        light,
        place,
        power=(source.angular(place) * colour).max(axis=-1) * phase,
        depth=np.broadcast_to(medium.sigma_t, 3)[colour > 0].min(initial=np.inf) * way,
    )
