"""A slab of fog under parallel light, in closed form: what both renderers have to agree with."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scenes.loader import load
from scenes.model import Scene

TOP, BOTTOM, FLOOR, REFLECTANCE = 1.0, -0.5, -0.8, 0.6
PHASE = "<phase type='hg'><float name='g' value='0.5'/></phase>"
GREY = "<float name='sigma_t' value='0.3'/>"
COLOURED = "<rgb name='sigma_t' value='0.05, 0.4, 1'/>"
THICK = "<float name='sigma_t' value='30'/>"


@dataclass(frozen=True)
class View:
    """A camera, and whether it is in the fog."""

    origin: str
    target: str
    inside: bool


VIEWS = {
    "from above": View("0, 4, 5", "0, 0, 0", inside=False),
    "from within, downward": View("0, 0.5, 0", "3, -0.8, 0", inside=True),
    "from within, upward into the light": View("0, 0, 0", "-1, 1.2, 0.4", inside=True),
}


def slab_scene(
    folder: Path, view: View, sigma_t: str = GREY, direction: str = "0.6, -1, -0.3", far: float = 300
) -> Scene:
    """Load a slab of 200 x 200, thin in y, over a floor."""
    path = folder / "slab.xml"
    path.write_text(
        f"""<scene version='3.0.0'>
          <medium type='homogeneous' id='fog'>{sigma_t}<float name='albedo' value='0.9'/>{PHASE}</medium>
          <shape type='cube'><bsdf type='null'/><ref name='interior' id='fog'/><transform name='to_world'>
            <scale x='100' y='{(TOP - BOTTOM) / 2}' z='100'/><translate y='{(TOP + BOTTOM) / 2}'/></transform></shape>
          <shape type='rectangle'><transform name='to_world'><scale value='100'/><rotate x='1' angle='-90'/>
            <translate y='{FLOOR}'/></transform>
            <bsdf type='diffuse'><rgb name='reflectance' value='{REFLECTANCE}'/></bsdf></shape>
          <emitter type='directional'><vector name='direction' value='{direction}'/>
            <rgb name='irradiance' value='3, 2, 1'/></emitter>
          <sensor type='perspective'><float name='fov' value='30'/><float name='far_clip' value='{far}'/>
            <transform name='to_world'><lookat origin='{view.origin}' target='{view.target}' up='0, 0, 1'/></transform>
            <film type='hdrfilm'/>{"<ref id='fog'/>" * view.inside}</sensor>
        </scene>"""
    )
    return load(path, size=(32, 24))


def slab_scattering(scene: Scene) -> np.ndarray:
    """Airlight, (H, W, 3): the fog on the ray and on the light's way there grows linearly along the ray."""
    origin, direction, begin, end, sun, slant = _geometry(scene)
    sigma_s, sigma_t = (np.broadcast_to(s, 3) for s in (scene.medium.sigma_s, scene.medium.sigma_t))
    first_leg = (TOP - origin[..., 1] - begin * direction[..., 1]) / slant
    growth = sigma_t * (1 - direction[..., 1] / slant)[..., None]
    length = (end - begin)[..., None]
    seen = np.exp(-sigma_t * first_leg[..., None]) * -np.expm1(-growth * length) / growth
    phase = scene.phase.evaluate(-direction @ sun)[..., None]
    return scene.lights[0].intensity * sigma_s * phase * seen


def slab_surface(scene: Scene) -> np.ndarray:
    """Light from the floor, (H, W, 3); its way to the floor and from there crosses the whole slab, or what is below."""
    _, direction, begin, end, _, slant = _geometry(scene)
    sigma_t = np.broadcast_to(scene.medium.sigma_t, 3)
    legs = (end - begin) + (TOP - BOTTOM) / slant
    light = scene.lights[0].intensity * slant * REFLECTANCE / np.pi
    return np.where((direction[..., 1] < 0)[..., None], light * np.exp(-np.multiply.outer(legs, sigma_t)), 0.0)


def _geometry(scene: Scene) -> tuple[np.ndarray, ...]:
    origin, direction, t_max = scene.camera.rays()
    top = (TOP - origin[..., 1]) / direction[..., 1]
    bottom = (BOTTOM - origin[..., 1]) / direction[..., 1]
    sun = scene.lights[0].direction
    end = np.minimum(np.maximum(top, bottom), t_max)
    begin = np.clip(np.minimum(top, bottom), 0, end)
    return origin, direction, begin, end, sun, -sun[1]
