"""Lit intervals that somebody else found, on the GPU: what a technique does with perfect knowledge of light and shadow.

The scattering pass reads them in place of the shadow map (shaders/given.glsl). Who finds them is no matter of OpenGL's:
`Renderer` is handed a `Finder`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gpu_impl.device import Device
from gpu_impl.shader_source import set_uniforms
from scenes.errors import InputError
from scenes.model import Array, Scene

# bindings of the two storage blocks of shaders/given.glsl
OFFSETS, INTERVALS = 6, 7


@dataclass(frozen=True, eq=False)
class Found:
    """Lit intervals of some rays for one light.

    Attributes
    ----------
    offsets : (rays + 1,) int    those of ray r are [offsets[r], offsets[r + 1])
    begin, end : (n,)            along the rays as `Camera.rays` has them [scene unit], sorted on each ray
    """

    offsets: NDArray[np.intp]
    begin: Array
    end: Array


# scene, which of its lights, positions in the image (h, w, 2) [pixel], ends (h, w): where OpenGL has the rays through
# them end [scene unit along `Camera.rays`] -> what is lit of those rays; a finder may know their ends better
Finder = Callable[[Scene, int, Array, Array], Found]


def find_none(scene: Scene, number: int, positions: Array, ends: Array) -> Found:
    """Stand in where nobody can find any.

    Raises
    ------
    InputError
        Always.
    """
    raise InputError(
        "Lit intervals of this technique come from ray casting, and nothing here casts rays: draw it by "
        "airlight.render or `airlight render`."
    )


class GivenIntervals:
    """Lit intervals of a lattice's rays, (begin, length) each, in two storage buffers."""

    def __init__(self, device: Device, found: Found, size: tuple[int, int]) -> None:
        self.found = found
        self._cells_in_row = size[0]
        pieces = np.column_stack([found.begin, found.end - found.begin]).astype(np.float32)
        # a buffer cannot be empty
        self._buffers = [
            device.context.buffer(part.tobytes() or bytes(16)) for part in (found.offsets.astype(np.uint32), pieces)
        ]

    def bind(self, program: Any) -> None:
        """Bind both, and set the uniform of shaders/given.glsl."""
        for binding, buffer in zip((OFFSETS, INTERVALS), self._buffers, strict=True):
            buffer.bind_to_storage_buffer(binding)
        set_uniforms(program, {"cells_in_row": self._cells_in_row})

    def release(self) -> None:
        """Give the buffers back."""
        for buffer in self._buffers:
            buffer.release()
