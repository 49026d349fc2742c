"""Frames timed in rounds that draw every technique once, so that whatever slows the machine down meets them all."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from experiments.intervals import Array
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import Technique
from gpu_impl.timing import PassClock

SEED = 51


@dataclass(frozen=True)
class Times:
    """What the clocks said of one technique in the rounds that count.

    Attributes
    ----------
    milliseconds : (rounds,)       wall clock of whole frames
    clocked : (rounds,)            the same of frames with a clock at each pass
    passes : dict of (rounds,)     what that clock says [ms]; a technique may have none of a pass
    """

    milliseconds: Array = field(default_factory=lambda: np.empty(0))
    clocked: Array = field(default_factory=lambda: np.empty(0))
    passes: Mapping[str, Array] = field(default_factory=dict)

    def pass_median(self, name: str) -> float:
        """Median of one pass [ms]; 0 where the technique has none of it."""
        return float(np.median(self.passes[name])) if name in self.passes else 0.0


def time_in_rounds(
    renderer: Renderer,
    techniques: Mapping[str, Technique],
    rounds: int,
    tell: Callable[[str], None] = lambda _: None,
    passes_too: bool = True,
) -> dict[str, Times]:
    """Time all techniques once a round, in an order drawn anew; nothing else may run meanwhile.

    Each draws the same frame of the same motion twice: with nothing but the whole timed, and with a clock at each pass,
    which comes first in every other round. The first round, in which shaders are compiled, does not count.

    Parameters
    ----------
    techniques : by names, which need not be the techniques' own: one may run twice
    rounds : int       that count; one more is run before them
    tell : callable    told what is being done
    passes_too : bool  False: whole frames alone, which halves the time; `clocked` and `passes` are empty

    Raises
    ------
    InputError
        A technique cannot draw the renderer's scene.
    """
    order = np.random.default_rng(SEED)
    plain: dict[str, list[float]] = {name: [] for name in techniques}
    clocked: dict[str, list[float]] = {name: [] for name in techniques}
    passes: dict[str, list[dict[str, float]]] = {name: [] for name in techniques}
    clock = PassClock(renderer.device)
    for number in range(rounds + 1):
        tell(f"round {number} of {rounds}")
        for name in order.permutation(list(techniques)).tolist():
            both = (False, True) if number % 2 == 0 else (True, False)
            for with_clock in both if passes_too else (False,):
                if with_clock:
                    clocked[name].append(renderer.frame_time(techniques[name], number, clock))
                    passes[name].append(clock.milliseconds())
                else:
                    plain[name].append(renderer.frame_time(techniques[name], number))
    return {
        name: Times(
            np.array(plain[name][1:]),
            np.array(clocked[name][1:]),
            {one: np.array([found[one] for found in passes[name][1:]]) for one in (passes[name] or [{}])[0]},
        )
        for name in techniques
    }
