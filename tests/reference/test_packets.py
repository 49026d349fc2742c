"""What is handed to Dr.Jit may be read to the end of its last packet."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from reference.integrator import mi

# isort: split
from reference.deterministic.packets import PACKET, packed

# All that `packed` has to read from ends where a page ends, and the next page is nobody's: the values that it is given
# and the room that it makes. A kernel that reads beyond either ends the process.
GUARDED = """
import ctypes, sys
import numpy as np
from reference.integrator import mi
import drjit as dr
from reference.deterministic.packets import packed

libc, page = ctypes.CDLL(None, use_errno=True), 4096
libc.mmap.restype = ctypes.c_void_p
libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_long]
libc.mprotect.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int]

def guarded(size, kind=float):
    base = libc.mmap(None, 2 * page, 3, 0x22, -1, 0)
    assert libc.mprotect(base + page, page, 0) == 0
    count = size * np.dtype(kind).itemsize
    return np.frombuffer((ctypes.c_char * count).from_address(base + page - count), kind)

numpys = np.zeros
for size in (1, 17, 20, 31, 33):
    values = guarded(size)
    values[:] = np.arange(size)
    made = []
    np.zeros = lambda *shape: made.append(guarded(*shape)) or made[-1]
    taken = packed(mi.Float64, values)
    np.zeros = numpys
    # it takes the memory that it is watched in
    assert [one.size >= size for one in made] == [True]
    twice = 2 * taken
    dr.eval(twice)
    assert (np.array(twice) == 2 * np.arange(size)).all()
print("read")
"""


def test_nothing_is_read_beyond_what_is_ours() -> None:
    run = subprocess.run([sys.executable, "-c", GUARDED], capture_output=True, text=True, timeout=120, check=False)
    assert (run.returncode, run.stdout) == (0, "read\n"), run.stderr


@pytest.mark.parametrize("size", [0, 1, PACKET - 1, PACKET, 1000])
def test_the_values_are_numpys(size: int) -> None:
    values = np.random.default_rng(size).normal(size=size)
    np.testing.assert_array_equal(np.array(packed(mi.Float64, values)), values)
    np.testing.assert_array_equal(np.array(packed(mi.Bool, values > 0)), values > 0)
    whole = np.arange(size)
    np.testing.assert_array_equal(np.array(packed(mi.UInt32, whole)), whole)
