"""The limits measured anew, and the references that cannot be used as they are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random

from experiments.gate import suite
from experiments.gate.agreement import FIRST_SEED, LAST_SEED, check_reference
from experiments.gate.limits import WRITTEN, Limit, Limits, limits_of
from experiments.gate.references import make_reference, write_reference
from experiments.gate.repeats import repeated_values
from experiments.gate.rounding import perturbed_values
from experiments.suite import Case
from scenes.errors import InputError

Tell = Callable[[str], None]


@dataclass(frozen=True)
class Change:
    """One limit before and after; None where there was or is none."""

    case: str
    metric: str
    old: Limit | None
    new: Limit | None


def renew_references(cases: Sequence[Case], seed: int, tell: Tell) -> Iterator[tuple[Path, str]]:
    """Estimate and write the references that are missing, damaged, stale, or no longer agree with Mitsuba.

    Parameters
    ----------
    seed : of the estimates that they are held against

    Yields
    ------
    path, why : Path, str    of each that was written, and a sentence
    """
    random = Random(seed)
    for name, scene in suite.gate_scenes(cases).items():
        tell(f"reference {name}")
        try:
            found = check_reference(suite.REFERENCES, scene, random.randrange(FIRST_SEED, LAST_SEED))
            why = "" if found.agrees else f"{found}."
        except InputError as error:
            why = str(error)
        if why:
            yield write_reference(suite.REFERENCES, scene, make_reference(scene)), why


def measure_limits(cases: Sequence[Case], runs: int, tell: Tell) -> Limits:
    """Measure all cases `runs` times on an idle machine, as often on a loaded one, and perturbed."""
    repeated = list(repeated_values([case.name for case in cases], runs, tell))
    return limits_of(repeated, list(perturbed_values(cases, tell)))


def changes(old: Limits, new: Limits) -> Iterator[Change]:
    """What is not as it was: values and margins that differ in the digits that are written."""
    for case in dict.fromkeys([*old, *new]):
        before, after = old.get(case, {}), new.get(case, {})
        for metric in dict.fromkeys([*before, *after]):
            one, other = before.get(metric), after.get(metric)
            if one is None or other is None or _differ(one, other):
                yield Change(case, metric, one, other)


def _differ(old: Limit, new: Limit) -> bool:
    pairs = ((old.value, new.value), (old.margin, new.margin))
    return any(abs(a - b) > WRITTEN * max(abs(a), abs(b)) for a, b in pairs)
