"""scenes.llvm: a library that would end the process is found out in another process, and passed over."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from scenes import llvm

GOOD = llvm.Llvm("/usr/lib/libLLVM.so.19.1", "19.1.7")


@pytest.fixture(autouse=True)
def fresh(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[None]:
    """Forget what this process, this user and this environment chose before, and restore it afterwards."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv(llvm.VARIABLE, "")
    monkeypatch.delitem(sys.modules, "drjit", raising=False)
    llvm.choose_llvm.cache_clear()
    yield
    llvm.choose_llvm.cache_clear()


@pytest.fixture
def text_file(tmp_path: Path) -> str:
    path = tmp_path / "libLLVM.so.99"
    path.write_text("not a library", encoding="utf-8")
    return str(path)


@pytest.fixture
def offer(monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[str]]:
    """Return a function that makes the given paths the only candidates, and GOOD the only one that passes the probe.

    The list that it returns fills with the paths that were probed.
    """

    def offer_these(*paths: str) -> list[str]:
        probed: list[str] = []

        def probe(path: str) -> llvm.Llvm | llvm.Rejected:
            probed.append(path)
            return GOOD if path == GOOD.path else llvm.Rejected(path, "was made up")

        monkeypatch.setattr(llvm, "_candidates", lambda asked_for: ([asked_for] if asked_for else []) + list(paths))
        monkeypatch.setattr(llvm, "_probe", probe)
        monkeypatch.setattr(llvm, "_key", lambda path: [path])
        return probed

    return offer_these


def test_a_text_file_cannot_be_loaded(text_file: str) -> None:
    assert llvm._probe(text_file) == llvm.Rejected(text_file, "cannot be loaded")


def test_a_missing_file_does_not_exist(tmp_path: Path) -> None:
    path = str(tmp_path / "libLLVM.so.19.1")
    assert llvm._probe(path) == llvm.Rejected(path, "does not exist")


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        ("import os; os.abort()", "aborts Dr.Jit's process (LLVM 99)"),
        ("import time; time.sleep(60)", "does not answer within 1 s"),
        ("import no_such_module", "cannot be tried, as drjit does not load (No module named 'no_such_module')"),
        ("raise SystemExit('LLVM version (14) is too old')", "is too old for Dr.Jit (LLVM 99)"),
        ("print('nothing of use')", "cannot be loaded"),
    ],
)
def test_each_way_to_fail_has_its_reason(
    monkeypatch: pytest.MonkeyPatch, text_file: str, code: str, reason: str
) -> None:
    monkeypatch.setattr(llvm, "_PROBE", code)
    monkeypatch.setattr(llvm, "_TIMEOUT", 1.0)
    assert llvm._probe(text_file) == llvm.Rejected(text_file, reason)


@pytest.mark.parametrize("path", [*llvm._candidates(None), "/no/such/libLLVM.so.19.1"])
def test_the_libraries_of_this_machine(path: str) -> None:
    result = llvm._probe(path)
    if llvm._major(path) in {15, 16}:  # Debian's Mesa brings 15
        assert result == llvm.Rejected(path, f"aborts Dr.Jit's process (LLVM {llvm._major(path)})")
    elif isinstance(result, llvm.Llvm):
        assert result.version.startswith(f"{llvm._major(path) or ''}")
    else:
        assert result.reason


def test_the_first_that_works_is_taken(offer: Callable[..., list[str]]) -> None:
    probed = offer("/bad", GOOD.path, "/never/tried")
    assert llvm.choose_llvm() == llvm.LlvmChoice(GOOD, (llvm.Rejected("/bad", "was made up"),))
    assert probed == ["/bad", GOOD.path]


def test_none_works(offer: Callable[..., list[str]]) -> None:
    offer("/bad", "/worse")
    choice = llvm.prepare()
    assert choice.usable is None
    assert [rejected.path for rejected in choice.rejected] == ["/bad", "/worse"]
    assert not os.environ[llvm.VARIABLE]


def test_a_bad_library_that_the_user_asked_for_is_reported_first(
    monkeypatch: pytest.MonkeyPatch, offer: Callable[..., list[str]]
) -> None:
    monkeypatch.setenv(llvm.VARIABLE, "/bad")
    offer(GOOD.path)
    choice = llvm.prepare()
    assert choice.asked_for == "/bad"
    assert choice.rejected[0].path == "/bad"
    assert os.environ[llvm.VARIABLE] == GOOD.path


def test_prepare_sets_what_drjit_reads(offer: Callable[..., list[str]]) -> None:
    offer(GOOD.path)
    assert llvm.prepare().usable == GOOD
    assert os.environ[llvm.VARIABLE] == GOOD.path
    assert llvm.prepare().usable == GOOD  # again: no error, the variable is ours


def test_prepare_refuses_to_come_too_late(monkeypatch: pytest.MonkeyPatch, offer: Callable[..., list[str]]) -> None:
    offer(GOOD.path)
    monkeypatch.setitem(sys.modules, "drjit", llvm)
    with pytest.raises(RuntimeError, match="before drjit is imported"):
        llvm.prepare()


def test_the_newest_version_comes_first(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    names = ["libLLVM-15.so.1", "libLLVM.so.19.1", "libLLVM-16.so.1", "libLLVM.so.100.1"]
    for name in names:
        (tmp_path / name).touch()
    (tmp_path / "libLLVM.so").symlink_to("libLLVM-15.so.1")
    found = [str(path) for path in tmp_path.iterdir()]
    monkeypatch.setattr(llvm.glob, "glob", lambda pattern: [])
    monkeypatch.setattr(llvm, "_known_to_loader", lambda: found)
    ordered = llvm._candidates("/asked/for")
    assert ordered[0] == "/asked/for"
    assert [Path(path).name for path in ordered[1:]] == [names[3], names[1], names[2], names[0]]


@pytest.mark.parametrize(
    ("name", "major"),
    [
        ("libLLVM-15.so.1", 15),
        ("libLLVM-14.0.6.so.1", 14),
        ("libLLVM.so.19.1", 19),
        ("libLLVM-19.so", 19),
        ("libLLVM.so", 0),
        ("libLLVMCore.so", 0),
    ],
)
def test_the_version_is_read_off_the_name(name: str, major: int) -> None:
    assert llvm._major(f"/usr/lib/{name}") == major


def test_a_success_is_remembered_and_a_failure_is_not(offer: Callable[..., list[str]]) -> None:
    offer("/bad", GOOD.path)
    first = llvm.choose_llvm()
    llvm.choose_llvm.cache_clear()
    probed = offer("/bad", GOOD.path)
    assert llvm.choose_llvm() == first
    assert probed == ["/bad"]


@pytest.mark.parametrize("damaged", ["", "{", "[]", "{}", '{"key": 1}', "\udcff"])
def test_a_damaged_memory_is_ignored(offer: Callable[..., list[str]], damaged: str) -> None:
    probed = offer(GOOD.path)
    llvm._memory().parent.mkdir(parents=True)
    llvm._memory().write_bytes(damaged.encode(errors="surrogateescape"))
    assert llvm.choose_llvm().usable == GOOD
    assert probed == [GOOD.path]


def test_a_library_that_changed_is_probed_again(text_file: str) -> None:
    llvm._remember(llvm.Llvm(text_file, "99.1"))
    assert llvm._remembered(text_file) == llvm.Llvm(text_file, "99.1")
    Path(text_file).write_text("an upgrade", encoding="utf-8")
    assert llvm._remembered(text_file) is None


def test_a_cache_folder_that_cannot_be_made_costs_only_the_probe(
    monkeypatch: pytest.MonkeyPatch, text_file: str, offer: Callable[..., list[str]]
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", text_file)  # a file where a folder should be
    offer(GOOD.path)
    assert llvm.choose_llvm().usable == GOOD
