"""The gate's result as JUnit XML, which servers for continuous integration show as tests."""

from __future__ import annotations

import re
from pathlib import Path

from junitparser import Failure, JUnitXml, Skipped, TestCase, TestSuite

from experiments.gate.gating import Result
from scenes.replacing import replacing

# what XML 1.0 (section 2.2) has no place for, not even escaped: NUL and most control characters, lone surrogates
NO_CHARACTER = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write_junit(result: Result, path: Path) -> None:
    """Write a test for each value, each reference that was estimated anew, and whatever could not be measured.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    suite = TestSuite("airlight gate")
    for verdict in result.verdicts:
        suite.add_testcase(_test(verdict.case, verdict.metric, "" if verdict.passes else str(verdict)))
    for one in result.agreements:
        test = _test(one.reference, "reference", "" if one.agrees else str(one))
        if one.comparison is None:
            test.result = [Skipped(_clean(one.reason))]
        suite.add_testcase(test)
    for name, reason in result.broken.items():
        suite.add_testcase(_test(name, "measured", reason))
    xml = JUnitXml()
    xml.add_testsuite(suite)
    with replacing(path) as beside:
        xml.write(str(beside), pretty=True)


def _test(case: str, name: str, failure: str) -> TestCase:
    test = TestCase(name, classname=_clean(case))
    if failure:
        test.result = [Failure(_clean(failure))]
    return test


def _clean(text: str) -> str:
    return NO_CHARACTER.sub("\N{REPLACEMENT CHARACTER}", text)
