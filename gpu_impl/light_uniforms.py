"""Uniforms of contract.glsl and light.glsl: the medium and one light."""

from __future__ import annotations

from typing import Any

import numpy as np

from scenes.model import Light, Scene


def light_uniforms(scene: Scene, light: Light) -> dict[str, Any]:
    """Uniforms of a pass that asks for one light in the scene's medium."""
    return {
        "sigma_s": tuple(np.broadcast_to(scene.medium.sigma_s, 3).tolist()),
        "sigma_t": tuple(np.broadcast_to(scene.medium.sigma_t, 3).tolist()),
        "light.position": tuple(light.position),
        "light.direction": tuple(light.direction),
        "light.intensity": tuple(light.intensity),
        "light.beam_width": light.beam_width,
        "light.cutoff_angle": light.cutoff_angle,
    }
