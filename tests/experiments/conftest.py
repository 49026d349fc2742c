"""The command line, run in this process."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from experiments import cli
from experiments.suite import load_suite


class Result:
    """What a command answered."""

    def __init__(self, code: int, out: str, err: str) -> None:
        self.code, self.out, self.err = code, out, err


@pytest.fixture
def airlight(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """Run a command line in this process, in a folder of its own."""
    monkeypatch.chdir(tmp_path)

    def run(*words: object) -> Result:
        monkeypatch.setattr(sys, "argv", ["airlight", *map(str, words)])
        code = 0
        try:
            cli.main()
        except SystemExit as end:
            code = int(end.code or 0)
        captured = capsys.readouterr()
        return Result(code, captured.out, captured.err)

    return run


@pytest.fixture
def suite(tmp_path: Path):
    """Load a suite from a text."""

    def read(text: str, *changes: str):
        path = tmp_path / "mine.toml"
        path.write_text(text)
        return load_suite(str(path), changes)[1]

    return read
