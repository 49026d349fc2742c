"""Measurements that do what drivers do on bad days; importing this registers them, and dask's workers preload it."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import types

from experiments.measurements import MEASUREMENTS, Measurement, Value
from experiments.measurements.shot import Shot


def crash(shot: Shot) -> dict[str, Value]:
    """End the process as a driver's fault does, in one technique of several."""
    if shot.technique.name == "Nishita1987":
        os.kill(os.getpid(), signal.SIGSEGV)
    return {"crash.frame": float(shot.frame.scattering.mean())}


def hang(shot: Shot) -> dict[str, Value]:
    """Stay in a call of C that Python cannot interrupt, in one technique of several."""
    if shot.technique.name == "Nishita1987":
        libc = ctypes.PyDLL(None)
        # holding the interpreter's lock, as a driver that is called through a binding does
        libc.sleep(600)
    return {"hang.frame": float(shot.frame.scattering.mean())}


def defect(shot: Shot) -> dict[str, Value]:
    """Raise what nobody expects, in one technique of several."""
    if shot.technique.name == "Nishita1987":
        raise ZeroDivisionError("a defect")
    return {"defect.frame": float(shot.frame.scattering.mean())}


for _function in (crash, hang, defect):
    _module = types.ModuleType(f"faulty_{_function.__name__}")
    _module.MEASUREMENT = Measurement(_function)  # type: ignore[attr-defined]
    sys.modules[_module.__name__] = _module
    MEASUREMENTS[_function.__name__] = _module.__name__
