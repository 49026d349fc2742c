"""The gate's cases, and the meshes that they are drawn with on every machine."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from experiments.run.work import load_case
from experiments.suite import Case, cases_of, load_suite
from scenes.errors import InputError
from scenes.meshes.files import VARIABLE
from scenes.messages import readable
from scenes.model import Scene

SUITE = "gate"
REFERENCES = Path(__file__).parent / "committed"


def gate_cases(names: Sequence[str] = ()) -> list[Case]:
    """The gate's cases, all of them or those that are named.

    Raises
    ------
    InputError
        There is no case of a name.
    """
    cases = cases_of(load_suite(SUITE, [f"reference.folder={REFERENCES}"])[1])
    known = {case.name: case for case in cases}
    for name in names:
        if name not in known:
            raise InputError(f"The gate has no case '{readable(name)}'; it has {', '.join(known)}.")
    return [known[name] for name in names] if names else cases


def gate_scenes(cases: Sequence[Case]) -> dict[str, Scene]:
    """The scenes that cases are drawn of, each once, by the name of their references."""
    from experiments.gate.references import reference_path

    scenes: dict[tuple[object, ...], Scene] = {}
    for case in cases:
        if case.view not in scenes:
            scenes[case.view] = load_case(case)
    return {reference_path(REFERENCES, scene).stem: scene for scene in scenes.values()}


@contextmanager
def stand_in_meshes() -> Iterator[None]:
    """Meanwhile no mesh is found but those that airlight makes, in this process and in those that it starts.

    Committed references are of stand-ins, and a machine that has the real meshes is to be gated too.
    """
    with tempfile.TemporaryDirectory(prefix="airlight-no-meshes-") as empty:
        before = {name: os.environ.get(name) for name in (VARIABLE, "XDG_DATA_HOME")}
        os.environ.pop(VARIABLE, None)
        os.environ["XDG_DATA_HOME"] = empty
        try:
            yield
        finally:
            for name, value in before.items():
                os.environ.pop(name, None)
                if value is not None:
                    os.environ[name] = value
