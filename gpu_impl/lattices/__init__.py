"""The registry of lattices. A new one is two files under `shaders/lattice` and a line here."""

from __future__ import annotations

from gpu_impl.lattices.epipolar import EPIPOLAR
from gpu_impl.lattices.grid import GRID
from gpu_impl.lattices.lattice import Lattice, LatticeKind

__all__ = ["LATTICES", "Lattice", "LatticeKind"]

LATTICES = {
    "grid": GRID,
    "epipolar": EPIPOLAR,
}
