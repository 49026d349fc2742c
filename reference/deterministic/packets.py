"""Numbers of numpy handed to Dr.Jit."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

# entries that a kernel takes at a time, at most: AVX-512 holds 64 bytes
PACKET = 64


def packed(kind: Any, values: NDArray[Any]) -> Any:
    """An array of Dr.Jit, such as `mi.Float64`, of numpy's values, (n,), which it may read entry by entry.

    Dr.Jit 1.5 takes numpy's memory as it stands, and its LLVM kernels read whole packets of it, the last past its end.
    Where the system's next page is nobody's, that ends the process: seen once in some thousand references. So what
    stands behind the end is ours.
    """
    room = np.zeros(values.size + PACKET, values.dtype)
    room[: values.size] = values
    return kind(room[: values.size])
