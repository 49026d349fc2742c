"""The tile of blue noise by which rays shift their samples (shaders/visibility/uniform_march_blue_noise.glsl)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gpu_impl.device import Device
from gpu_impl.shader_source import set_uniforms
from gpu_impl.void_and_cluster import void_and_cluster

# pixels on a side; a tenth of a second's work
SIZE = 64
SEED = 1993
# texture unit, behind those of light_uniforms.py and passes/shadow_volume.py
UNIT = 10


@cache
def blue_noise() -> NDArray[np.float32]:
    """Values spread evenly over 0 to 1, (`SIZE`, `SIZE`); neighbours differ as much as can be."""
    return ((void_and_cluster(SIZE, SEED) + 0.5) / SIZE**2).astype(np.float32)


@contextmanager
def blue_noise_uniforms(device: Device, program: Any) -> Iterator[None]:
    """Hand the tile over as `blue_noise`."""
    texture = device.texture((SIZE, SIZE), 1)
    texture.write(blue_noise().tobytes())
    texture.use(UNIT)
    set_uniforms(program, {"blue_noise": UNIT})
    try:
        yield
    finally:
        device.give_back(texture)
