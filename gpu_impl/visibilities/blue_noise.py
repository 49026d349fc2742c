"""The tile of blue noise by which rays shift their samples (shaders/visibility/uniform_march_blue_noise.glsl)."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gpu_impl.device import Device
from gpu_impl.shader_source import set_uniforms
from gpu_impl.visibilities.strategy import FogInputs, Supply
from gpu_impl.visibilities.void_and_cluster import void_and_cluster

# pixels on a side; a tenth of a second's work
SIZE = 64
SEED = 1993
# texture unit, behind those of light_uniforms.py and shadow_polygons.py
UNIT = 10


@cache
def blue_noise() -> NDArray[np.float32]:
    """Values spread evenly over 0 to 1, (`SIZE`, `SIZE`); neighbours differ as much as can be."""
    return ((void_and_cluster(SIZE, SEED) + 0.5) / SIZE**2).astype(np.float32)


class BlueNoise(Supply):
    """The tile, as `blue_noise`."""

    def __init__(self, inputs: FogInputs) -> None:
        self._texture = inputs.device.texture((SIZE, SIZE), 1)
        self._texture.write(blue_noise().tobytes())

    def bind(self, program: Any) -> None:
        """Bind the tile."""
        self._texture.use(UNIT)
        set_uniforms(program, {"blue_noise": UNIT})

    def give_back(self, device: Device) -> None:
        """Give the tile back."""
        device.give_back(self._texture)
