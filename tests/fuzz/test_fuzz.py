"""Thousands of spoilt scenes and meshes end in a picture or in one sentence.

AIRLIGHT_FUZZ_SEED and AIRLIGHT_FUZZ_SCENES make another or a longer run; runner.py does so without pytest.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from runner import LIMIT, Report, _keep, all_cases, fuzz
from seeds import scenes, write_files

from scenes.loader import load

SEED = int(os.environ.get("AIRLIGHT_FUZZ_SEED", "1"))
SCENES = int(os.environ.get("AIRLIGHT_FUZZ_SCENES", "3500"))
MESHES = SCENES // 10


def told(report: Report, keep: Path) -> str:
    """What to read when the test fails."""
    faults = "\n\n".join(f"{case}: {fault[:1500]}" for case, fault in report.faults[:20])
    return f"{len(report.faults)} faults, files in {keep}:\n{faults}\nslowest: {report.slowest}"


def test_spoilt_scenes_and_meshes_end_in_a_picture_or_a_sentence(
    tmp_path: Path, record_testsuite_property: Callable[[str, object], None]
) -> None:
    """All of them, however slow the machine is; CI has a minute for it, and the time is in pytest's --junit-xml."""
    keep = tmp_path / "faults"
    limit = LIMIT * max(1.0, SCENES / 3500)
    report = fuzz(all_cases(SCENES, MESHES), SEED, keep, limit=limit)
    record_testsuite_property("seconds of the fuzzer", round(report.seconds, 1))
    assert not report.faults, told(report, keep)
    assert report.left == 0, f"{report.left} cases hung or were not reached in {limit:.0f} s; {told(report, keep)}"
    ends = report.ends
    # each was run, and neither end is so rare that it would say little
    assert ends["scene picture"] + ends["scene sentence"] == SCENES
    assert ends["mesh picture"] + ends["mesh sentence"] == MESHES
    assert min(ends.values()) > 0.1 * MESHES
    assert ends["scene picture"] > 0.15 * SCENES


def test_every_kind_of_fault_is_noticed(tmp_path: Path) -> None:
    """And the run goes on after each."""
    words = {
        0: "ended the process (exit code -6)",
        1: "hung for 2 s",
        2: "ZeroDivisionError",
        3: "warned: ",
        4: "printed: fog",
        5: "has no full stop",
        6: "MemoryError",
    }
    report = fuzz([f"planted {deed}" for deed in words], SEED, keep=tmp_path, patience=2)
    faults = dict(report.faults)
    assert report.ends == {"planted fault": len(words)}
    for deed, expected in words.items():
        assert expected in faults[f"planted {deed}"]
        assert (tmp_path / f"{SEED}-planted-{deed}" / "fault.txt").exists()


def test_a_case_that_failed_is_kept_with_all_that_it_names(tmp_path: Path) -> None:
    """And with none of the cases before it."""
    folder, keep = tmp_path / "folder", tmp_path / "keep"
    write_files(folder)
    for number in (1, 2):
        (folder / f"scene{number}.xml").write_text(scenes()["spots"])
        _keep(folder, keep / str(number), f"scene {number}", "refused")
    for number in (1, 2):
        assert load(keep / str(number) / f"scene{number}.xml", size=(4, 4)).meshes
        assert [file.name for file in (keep / str(number)).glob("scene*")] == [f"scene{number}.xml"]
