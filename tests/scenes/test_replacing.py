"""A file takes its place whole, with the rights and in the place that anybody would expect."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from scenes.errors import InputError
from scenes.file_names import check_name
from scenes.replacing import replacing


def written(path: Path) -> Path:
    with replacing(path) as beside:
        beside.write_text("new")
    return path


@pytest.mark.parametrize("umask", [0o022, 0o077, 0o002])
def test_the_umask_decides_who_may_read_it(tmp_path: Path, umask: int) -> None:
    before = os.umask(umask)
    try:
        path = written(tmp_path / "a.txt")
    finally:
        os.umask(before)
    assert path.stat().st_mode & 0o777 == 0o666 & ~umask


@pytest.mark.parametrize("exists", [True, False])
def test_a_link_stays_and_its_target_is_written(tmp_path: Path, exists: bool) -> None:
    (tmp_path / "elsewhere").mkdir()
    target, link = tmp_path / "elsewhere" / "a.txt", tmp_path / "link.txt"
    if exists:
        target.write_text("old")
    link.symlink_to("elsewhere/a.txt")
    written(link)
    assert link.is_symlink()
    assert target.read_text() == "new"
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["a.txt", "elsewhere", "link.txt"]


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_whatever_goes_wrong_the_old_file_stays(tmp_path: Path, error: type[BaseException]) -> None:
    (tmp_path / "a.txt").write_text("old")

    def interrupted() -> None:
        with replacing(tmp_path / "a.txt") as beside:
            beside.write_text("half")
            raise error

    with pytest.raises(error):
        interrupted()
    assert [path.read_text() for path in tmp_path.iterdir()] == ["old"]


def test_a_place_that_cannot_be_written_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "link.txt").symlink_to("none/a.txt")
    for path in (tmp_path / "none" / "a.txt", tmp_path / "link.txt"):
        with pytest.raises(InputError, match=f"{path.name} cannot be written"):
            written(path)


def test_a_name_that_is_not_utf_8_is_shown_by_its_bytes() -> None:
    check_name("nébel π.xml")
    with pytest.raises(InputError, match=r"^b\\xff\.xml has a name that is not UTF-8; rename it\.$"):
        check_name(os.fsdecode(b"b\xff.xml"))
