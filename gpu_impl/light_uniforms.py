"""One light in the scene's fog, as shaders see it: defines, uniforms and textures of light.glsl and fog.glsl."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gpu_impl.textures import PictureTextures
from scenes.model import Light, Scene

# texture unit of a spot's picture; the passes bind theirs from 0 on
SPOT_UNIT = 8


def placed(light: Light, bounds: np.ndarray) -> Light:
    """Give a directional light a position from which it sees every surface before it; others have theirs.

    Parameters
    ----------
    bounds : (8, 3)    corners of the box around the surfaces [scene unit]
    """
    if light.kind != "directional":
        return light
    along = bounds @ light.direction
    nearest, depth = along.min(), max(float(np.ptp(along)), 1e-6)
    centre = bounds.mean(axis=0)
    return replace(light, position=centre + light.direction * (nearest - centre @ light.direction - depth))


def fog_defines(scene: Scene) -> dict[str, int]:
    """Defines of fog.glsl."""
    holder = scene.boundary
    return {
        "GREY": int(np.ptp(np.broadcast_to(scene.medium.sigma_t, 3)) == 0),
        "FOG_PLANES": 0 if holder is None else len(holder.planes),
        "FOG_BALL": int(holder is not None and holder.ball is not None),
    }


def fog_uniforms(scene: Scene) -> dict[str, Any]:
    """The medium, and the uniforms of fog.glsl."""
    uniforms: dict[str, Any] = {
        "sigma_s": tuple(np.broadcast_to(scene.medium.sigma_s, 3).tolist()),
        "sigma_t": tuple(np.broadcast_to(scene.medium.sigma_t, 3).tolist()),
    }
    if scene.boundary is not None:
        uniforms["fog_planes"] = [tuple(plane) for plane in scene.boundary.planes]
        if scene.boundary.ball is not None:
            uniforms["fog_ball"] = tuple(scene.boundary.ball)
    return uniforms


def light_defines(scene: Scene, light: Light) -> dict[str, int]:
    """Defines that decide which parts of the shaders one light in the scene's fog needs."""
    holder = scene.boundary
    in_fog = holder is None or (light.kind != "directional" and bool(holder.contains(light.position)))
    return {
        **fog_defines(scene),
        "DIRECTIONAL": int(light.kind == "directional"),
        "WHOLE_LEG": int(in_fog),
        "SPOT": 0 if light.kind != "spot" else 1 if light.beam_width >= light.cutoff_angle else 2,
        "SPOT_TEXTURE": int(light.texture is not None),
    }


def light_uniforms(scene: Scene, light: Light, pictures: PictureTextures) -> dict[str, Any]:
    """Uniforms of a pass that asks for one light in the scene's medium; a spot's picture is bound."""
    uniforms: dict[str, Any] = {
        **fog_uniforms(scene),
        "light.position": tuple(light.position),
        "light.direction": tuple(light.direction),
        "light.intensity": tuple(light.intensity),
        "light.beam_width": light.beam_width,
        "light.cutoff_angle": light.cutoff_angle,
        "tan_cutoff": float(np.tan(light.cutoff_angle)),
    }
    if light.texture is not None:
        uniforms |= pictures.bind(light.texture, SPOT_UNIT, "spot_texture", "spot_bitmap")
        uniforms["world_to_light"] = np.linalg.inv(light.to_world)
    return uniforms
