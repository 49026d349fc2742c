"""Pieces of rays as a technique hands them to its airlight model, for whoever wants to evaluate them otherwise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gpu_impl.shader_source import set_uniforms

# bindings of the two storage blocks of shaders/recording.glsl
COUNT, PIECES = 0, 1
# uint32 values of a piece
WORDS = 4


@dataclass(frozen=True, eq=False)
class Pieces:
    """What a technique calls lit of one light: float32 as the model got them, sorted by cell and begin.

    Attributes
    ----------
    positions : (h, w, 2)     where in the image each cell looks [pixel]; see shaders/lattice_rays.frag.glsl
    start : (h, w)            how far behind the beginning of `Camera.rays` the fog begins there [scene unit]
    cell : (n,) int           each piece's, row by row
    t0, dt : (n,)             begin, counted from `start`, and length [scene unit], inside the light's cone where the
                              model asks for that
    w : (n,)                  weight, of any sign
    t_max : (h, w)            how long each cell's ray in fog is [scene unit]; not positive where there is no fog
    """

    positions: NDArray[np.float32]
    start: NDArray[np.float32]
    cell: NDArray[np.int64]
    t0: NDArray[np.float32]
    dt: NDArray[np.float32]
    w: NDArray[np.float32]
    t_max: NDArray[np.float32]


class Recording:
    """Room for the pieces of one light.

    Parameters
    ----------
    room : int            pieces
    cells_in_row : int    of the lattice
    """

    def __init__(self, context: Any, room: int, cells_in_row: int) -> None:
        self._context, self._cells_in_row = context, cells_in_row
        self._count = context.buffer(bytes(4))
        self._pieces = context.buffer(reserve=4 * WORDS * max(room, 1))

    def bind(self, program: Any) -> None:
        """Bind both buffers, and set the uniform of shaders/recording.glsl."""
        self._count.bind_to_storage_buffer(COUNT)
        self._pieces.bind_to_storage_buffer(PIECES)
        set_uniforms(program, {"recorded_row": self._cells_in_row})

    @property
    def reported(self) -> int:
        """How many pieces there were, with room or without."""
        # a driver may not know that the shader wrote here
        self._context.finish()
        return int(np.frombuffer(self._count.read(), np.uint32)[0])

    def read(self, rays: NDArray[np.float32]) -> Pieces:
        """Sort what was recorded.

        Parameters
        ----------
        rays : (h, w, 4)    what shaders/lattice_rays.frag.glsl draws
        """
        words = np.frombuffer(self._pieces.read(4 * WORDS * self.reported), np.uint32).reshape(-1, WORDS)
        cell = words[:, 0].astype(np.int64)
        t0, dt, w = np.ascontiguousarray(words[:, 1:].T).view(np.float32)
        order = np.lexsort([t0, cell])
        return Pieces(rays[..., :2], rays[..., 2], cell[order], t0[order], dt[order], w[order], rays[..., 3])

    def close(self) -> None:
        """Give the buffers back."""
        self._count.release()
        self._pieces.release()
