"""Clocks for the passes of a frame."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Any, Protocol

from gpu_impl.device import Device

# the passes as the renderer names them, in the order in which a frame runs them
PASSES = ("geometry", "shadow map", "shadow polygons", "surface", "scattering", "combination")
WALL_CLOCK, TIMER_QUERIES = "wall clock around glFinish", "GL_TIME_ELAPSED"


class Clock(Protocol):
    """Whatever a renderer tells of its passes."""

    def time_pass(self, name: str) -> AbstractContextManager[None]:
        """Stand around one pass, or around a part of it."""


class NoClock:
    """For frames that nobody times pass by pass."""

    def time_pass(self, name: str) -> AbstractContextManager[None]:
        """Do nothing: no query, no glFinish."""
        return nullcontext()


NO_CLOCK = NoClock()


class PassClock:
    """Adds up the milliseconds of each pass.

    Hardware is asked by timer queries, which nothing waits for until `milliseconds` does. A software rasteriser answers
    those with the time in which it took the commands, not in which it drew, so that there the wall clock runs from one
    glFinish to the next; that keeps passes from overlapping, and a frame may be slower for it.

    Attributes
    ----------
    method : str    `WALL_CLOCK` or `TIMER_QUERIES`
    """

    def __init__(self, device: Device) -> None:
        self._context = device.context
        self.method = WALL_CLOCK if device.info.is_software else TIMER_QUERIES
        self._measured: list[tuple[str, Any]] = []
        # read, and free for the next pass: moderngl cannot release a query
        self._spare: list[Any] = []

    @contextmanager
    def time_pass(self, name: str) -> Iterator[None]:
        """Stand around one pass, or around a part of it; passes do not nest."""
        if self.method == TIMER_QUERIES:
            query = self._spare.pop() if self._spare else self._context.query(time=True)
            with query:
                yield
            self._measured.append((name, query))
            return
        self._context.finish()
        begin = time.perf_counter()
        yield
        self._context.finish()
        self._measured.append((name, time.perf_counter() - begin))

    def milliseconds(self) -> dict[str, float]:
        """Return the time of each pass that ran since the last call [ms], several runs of one pass added up."""
        passes: dict[str, float] = {}
        for name, measured in self._measured:
            if self.method == TIMER_QUERIES:
                elapsed = 1e-6 * measured.elapsed
                self._spare.append(measured)
            else:
                elapsed = 1e3 * measured
            passes[name] = passes.get(name, 0.0) + elapsed
        self._measured.clear()
        return passes
