"""`airlight audit`: what it prints, what it writes, and when it complains."""

from __future__ import annotations

import json
from io import StringIO

import pytest
from rich.console import Console
from typer.testing import CliRunner

from analytic.thesis.audit import EQUATIONS, Entry, audit
from experiments import bars
from experiments.audit import report as command
from experiments.cli import app
from scenes.errors import InputError

KEYS = ["equation", "verdict", "finding", "residual_printed", "residual_repaired"]
# quick ones of each kind
SOME = ["2", "12", "21", "27", "29", "Alg. 4.2"]


@pytest.fixture
def some(monkeypatch):
    """The command with six equations in place of 35."""
    entries = audit(SOME)
    monkeypatch.setattr(command, "audit_one_by_one", lambda: iter(entries))
    return entries


def test_json_is_all_that_is_printed(some, capsys):
    assert command.run_audit(as_json=True)
    printed = capsys.readouterr()
    found = json.loads(printed.out)
    assert [list(entry) for entry in found] == [KEYS] * len(SOME)
    assert [entry["equation"] for entry in found] == SOME
    assert all(isinstance(entry["residual_printed"], float) for entry in found)
    assert not printed.err


def test_the_table(some, capsys):
    assert command.run_audit()
    printed = capsys.readouterr().out
    for entry in some:
        assert f" {entry.equation} " in printed
    assert "2 right, 4 wrong as printed" in printed


def test_a_repair_that_does_not_agree_is_an_error(some, monkeypatch, capsys):
    bad = [*some, Entry("99", "wrong: it", "A finding.", 1.0, 2e-20)]
    monkeypatch.setattr(command, "audit_one_by_one", lambda: iter(bad))
    assert not command.run_audit()
    assert "Not repaired: 99." in capsys.readouterr().out
    nothing = [*some, Entry("99", "wrong: it", "A finding.", 1.0, None)]
    monkeypatch.setattr(command, "audit_one_by_one", lambda: iter(nothing))
    assert command.run_audit()
    not_a_number = [*some, Entry("99", "wrong: it", "A finding.", 1.0, float("nan"))]
    monkeypatch.setattr(command, "audit_one_by_one", lambda: iter(not_a_number))
    assert not command.run_audit()


def test_the_page(some, tmp_path, capsys):
    folder = tmp_path / "made" / "here"
    assert command.run_audit(as_json=True, out=folder)
    assert json.loads((folder / "audit.json").read_text()) == json.loads(capsys.readouterr().out)
    page = (folder / "README.md").read_text()
    assert "    airlight audit --out results/audit\n" in page
    assert "2 are right as printed, 4 are wrong." in page
    # what was read, and which two equations are held against the thesis itself
    words = " ".join(page.split())
    assert "are read from an extracted text of the thesis" in words
    assert "Eqs. 31 and 32 alone relate the thesis's own i and j" in words
    rows = [line for line in page.splitlines() if line.startswith("| ")][1:]
    assert [row.split(" | ")[0].lstrip("| ") for row in rows] == SOME
    # each has five bars, whatever a verdict holds
    assert all(row.replace("\\|", "").count("|") == 5 for row in rows)
    for entry in some:
        assert f"- **{entry.equation}**: " in page


def test_a_folder_that_cannot_be_written_is_refused_first(monkeypatch, tmp_path):
    def never():
        raise AssertionError("computed before the folder was tried")

    monkeypatch.setattr(command, "audit_one_by_one", never)
    file = tmp_path / "file"
    file.touch()
    with pytest.raises(InputError, match="choose another --out"):
        command.run_audit(out=file)
    with pytest.raises(InputError, match="choose another --out"):
        command.run_audit(out=file / "below")


def test_a_bar_moves_on_a_terminal_and_nowhere_else(some, monkeypatch, capsys):
    terminal = Console(file=StringIO(), force_terminal=True, width=80)
    monkeypatch.setattr(bars, "notices", terminal)
    monkeypatch.setattr(command, "notices", terminal)
    command.run_audit(as_json=True)
    assert f"{len(SOME)}/{len(EQUATIONS)}" in terminal.file.getvalue()
    assert json.loads(capsys.readouterr().out)


def test_the_command_line_gives_the_exit_code(some, monkeypatch):
    assert CliRunner().invoke(app, ["audit", "--json"]).exit_code == 0
    bad = [*some, Entry("99", "wrong: it", "A finding.", 1.0, 2e-20)]
    monkeypatch.setattr(command, "audit_one_by_one", lambda: iter(bad))
    assert CliRunner().invoke(app, ["audit", "--json"]).exit_code == 1
