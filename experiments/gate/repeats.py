"""The same values measured again and again, each time in a new process, on an idle machine and on a loaded one."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack, contextmanager

from experiments.gate.measuring import Values, measure_cases
from experiments.gate.suite import gate_cases

# Widths of llvmpipe's vectors [bit], which choose other paths through its code generator; 0 for its own choice. 512 it
# takes only where it is told to, and crashes then on levels of textures and on some loops (Mesa 22.3.6).
WIDTHS = (0, 128, 256)
WIDTH_VARIABLE = "LP_NATIVE_VECTOR_WIDTH"


def repeated_values(
    names: Sequence[str], runs: int, tell: Callable[[str], None] = lambda text: None
) -> Iterator[Values]:
    """Values of the named cases from `runs` runs on an idle machine and as many on a loaded one."""
    context = multiprocessing.get_context("spawn")
    with ExitStack() as busy:
        for number in range(2 * runs):
            if number == runs:
                busy.enter_context(_loaded(context))
            tell(f"{'idle' if number < runs else 'loaded'} run {number % runs + 1} of {runs}")
            with _width(WIDTHS[number % len(WIDTHS)]), ProcessPoolExecutor(1, mp_context=context) as process:
                yield process.submit(_measure, list(names)).result()


def _measure(names: list[str]) -> Values:
    return measure_cases(gate_cases(names))


@contextmanager
def _width(bits: int) -> Iterator[None]:
    before = os.environ.get(WIDTH_VARIABLE)
    if bits:
        os.environ[WIDTH_VARIABLE] = str(bits)
    try:
        yield
    finally:
        os.environ.pop(WIDTH_VARIABLE, None)
        if before is not None:
            os.environ[WIDTH_VARIABLE] = before


@contextmanager
def _loaded(context: multiprocessing.context.SpawnContext) -> Iterator[None]:
    """Keep every core busy meanwhile."""
    spinning = [context.Process(target=_spin, daemon=True) for _ in range(os.cpu_count() or 1)]
    for one in spinning:
        one.start()
    try:
        yield
    finally:
        for one in spinning:
            one.terminate()
            one.join()


def _spin() -> None:
    while True:
        pass
