"""Pictures of one value."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from experiments.exr import write_exr


def picture(path: str, value: float = 1.0, size: tuple[int, int] = (4, 6), layer: str = "composite") -> str:
    """Write a file of one layer and give its name back."""
    write_exr(Path(path), {layer: np.full((*size, 3), value, np.float32)}, {})
    return path
