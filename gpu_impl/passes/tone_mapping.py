"""Tone mapping, for display only: no number that airlight reports comes from here."""

from __future__ import annotations

from typing import Any

import numpy as np

from gpu_impl.device import Device
from gpu_impl.shader_source import set_uniforms


def tone_map(device: Device, target: Any, composite: Any, exposure: float) -> None:
    """Map a picture's luminance to what a display shows, and encode it as sRGB.

    Parameters
    ----------
    target : RGBA8         sRGB
    composite : RGBA32F    linear Rec.709
    exposure : float       factor on every radiance before it is mapped

    Raises
    ------
    ValueError
        `exposure` is not positive and finite.

    Source: Reinhard, Stark, Shirley and Ferwerda 2002, Eq. 4, with an exposed luminance of 4 as white.
    """
    if not (0 < exposure < np.inf):
        raise ValueError(f"exposure must be positive and finite, not {exposure}")
    program = device.program("tone_mapping.frag.glsl")
    composite.use(0)
    set_uniforms(program, {"composite": 0, "exposure": exposure})
    device.fill(program, target)
