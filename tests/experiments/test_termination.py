"""SIGTERM in the middle of a long command ends it by an exception: its temporary files go, its references are kept."""

from __future__ import annotations

import os
import signal

import pytest

import experiments.benchmark.report
import experiments.run.cluster


@pytest.mark.parametrize(
    ("command", "work", "name"),
    [
        (("benchmark", "reference", "sphere", "--size", 4, 4), experiments.benchmark.report, "run_benchmark"),
        (("run", "quick", "--set", "scenes=empty"), experiments.run.cluster, "cluster"),
    ],
    ids=["benchmark", "run"],
)
def test_told_to_end_a_command_ends_by_an_exception(command, work, name, airlight, monkeypatch) -> None:
    unwound = []

    def told_to_end(*_: object) -> None:
        # or the signal would end the tests
        assert callable(signal.getsignal(signal.SIGTERM))
        try:
            os.kill(os.getpid(), signal.SIGTERM)
        finally:
            unwound.append(name)

    monkeypatch.setattr(work, name, told_to_end)
    assert airlight(*command).code == 128 + signal.SIGTERM
    assert unwound == [name]
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
