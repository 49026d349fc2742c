"""What a program does when it is told to end."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["terminated_cleanly"]


@contextmanager
def terminated_cleanly() -> Iterator[None]:
    """Let SIGTERM end the program by an exception, so that what was begun is removed or kept; by default nothing is."""

    def end(number: int, _: object) -> None:
        # the exit code by which shells know a signal
        raise SystemExit(128 + number)

    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
