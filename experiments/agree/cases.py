"""The cases of `airlight agree`, a scene with a phase function each, and what was found in one."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from experiments.provenance import describe_scene
from reference.agreement.comparison import Comparison
from reference.agreement.witnesses import Report, Witnesses, call_witnesses
from reference.mutations import MUTATIONS, Outcome, try_mutation
from scenes.catalogue import FOLDER, shipped
from scenes.errors import InputError
from scenes.model import Scene

# relative bias of the image mean that the main estimator is to show against the deterministic mode in each case
OWN_POWER = 1e-3


@dataclass(frozen=True)
class Case:
    """A scene's name or path, and the parameters that it is loaded with."""

    scene: str
    parameters: dict[str, str]

    @property
    def name(self) -> str:
        """Scene and phase function, where one is asked for."""
        return f"{self.scene} {self.parameters['phase']}" if "phase" in self.parameters else self.scene


@dataclass(frozen=True)
class Finding:
    """What was found in a case.

    Attributes
    ----------
    case : Case
    about : dict                        the scene, as `describe_scene` has it
    phase : str
    witnesses : Witnesses or None       None where the case failed
    comparisons : tuple of Comparison   each pair; none where the case failed
    outcomes : tuple of Outcome         of the mutations, if they were tried
    seconds : float
    failure : str                       why there is nothing else; "" where there is
    """

    case: Case
    about: dict[str, str]
    phase: str
    witnesses: Witnesses | None
    comparisons: tuple[Comparison, ...]
    outcomes: tuple[Outcome, ...]
    seconds: float
    failure: str = ""

    @property
    def agrees(self) -> bool:
        """Whether all pairs do, and the surfaces under both conventions."""
        return (
            self.witnesses is not None
            and self.witnesses.surfaces.agrees
            and all(comparison.agrees for comparison in self.comparisons)
        )

    @property
    def unnoticed(self) -> list[str]:
        """Mutations that matter here, and that no test noticed which passes the right estimate."""
        return [outcome.mutation.name for outcome in self.outcomes if not (outcome.noticed or outcome.idle)]

    @property
    def sharp(self) -> bool:
        """Whether a bias of OWN_POWER of the main estimator's image mean would show."""
        return not self.failure and self.comparisons[0].verdicts[2].power <= OWN_POWER


def list_cases(scenes: Sequence[str], all_scenes: bool, every_phase: bool, parameters: dict[str, str]) -> list[Case]:
    """Each scene, or each with each phase function of `scenes/phase` with its own parameters.

    Raises
    ------
    InputError
        No scene is named, scenes are named beside --all, or a phase function beside --every-phase.
    """
    if bool(scenes) == all_scenes:
        raise InputError("Name a scene or several, or use --all in their place.")
    if every_phase and "phase" in parameters:
        raise InputError("-p phase= and --every-phase exclude each other; leave one out.")
    names = shipped() if all_scenes else list(dict.fromkeys(scenes))
    phases = sorted(path.stem for path in (FOLDER / "phase").glob("*.xml")) if every_phase else []
    with_phase = [parameters | {"phase": phase} for phase in phases] or [parameters]
    return [Case(name, one) for name in names for one in with_phase]


def examine(scene: Scene, case: Case, time_limit: float, mutations: bool, report: Report) -> Finding:
    """Call the witnesses of a case, and spoil the estimator if asked to; `report` says who is at work."""
    begin = time.perf_counter()
    witnesses = call_witnesses(scene, time_limit, report)
    outcomes = tuple(
        try_mutation(mutation, scene, witnesses, _in_the_course_of(mutation.name, report))
        for mutation in (MUTATIONS if mutations else ())
    )
    seconds = time.perf_counter() - begin
    return Finding(case, describe_scene(scene), scene.phase.name, witnesses, witnesses.comparisons(), outcomes, seconds)


def failed(case: Case, error: Exception, seconds: float) -> Finding:
    """A case that came to nothing."""
    reason = str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}"
    phase = case.parameters.get("phase", "")
    return Finding(case, {}, phase, None, (), (), seconds, " ".join(reason.split()))


def _in_the_course_of(name: str, report: Report) -> Callable[[str, Any], None]:
    return lambda witness, progress: report(f"{name}: {witness}", progress)
