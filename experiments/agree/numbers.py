"""The numbers of `airlight agree` for other programs: agreement.json, and the layers of z.exr."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from experiments.agree.cases import Finding
from reference.agreement.comparison import Comparison
from reference.agreement.pooled import Pooled
from reference.agreement.significance import SIGNIFICANCE
from reference.agreement.witnesses import Witnesses


def as_json(findings: Sequence[Finding], over_all: Pooled | None) -> dict[str, Any]:
    """All numbers of the page; null for a bias where none would be caught."""
    return {
        "significance": SIGNIFICANCE,
        "pooled": over_all and {key: _number(value) for key, value in asdict(over_all).items()},
        "cases": [_case(finding) for finding in findings],
    }


def exr_layers(witnesses: Witnesses, comparisons: Sequence[Comparison]) -> dict[str, Any]:
    """Scores by pair; means and errors by witness, those under `volpath`'s convention by their own names."""
    layers = {
        f"z.{comparison.first.name}_{comparison.second.name}": comparison.verdicts[0].scores
        for comparison in comparisons
    }
    for kind, several in (("scattering", witnesses.airlight), ("composite_as_volpath", witnesses.composite)):
        for one in several:
            layers[f"mean.{kind}.{one.name}"] = one.pixels.mean
            layers[f"standard_error.{kind}.{one.name}"] = one.pixels.variance**0.5
    return layers


def _case(finding: Finding) -> dict[str, Any]:
    found: dict[str, Any] = {
        "scene": finding.case.scene,
        "parameters": finding.case.parameters,
        "phase": finding.phase,
        "about": finding.about,
        "agrees": finding.agrees,
        "failure": finding.failure,
        "seconds": finding.seconds,
        "comparisons": [_comparison(comparison) for comparison in finding.comparisons],
        "mutations": [
            {
                "mutation": outcome.mutation.name,
                "meaning": outcome.meaning,
                "idle": outcome.idle,
                "noticed": outcome.noticed,
                "comparisons": [_comparison(comparison) for comparison in outcome.comparisons],
                "controls": [_comparison(control) for control in outcome.controls],
            }
            for outcome in finding.outcomes
        ],
    }
    if finding.witnesses:
        keys = ("convention_shift", "volpath_error", "volpath_samples")
        found |= {key: _number(getattr(finding.witnesses, key)) for key in keys}
        found["surfaces"] = {**asdict(finding.witnesses.surfaces), "agrees": finding.witnesses.surfaces.agrees}
        found["seconds_by_witness"] = finding.witnesses.seconds
    return found


def _comparison(comparison: Comparison) -> dict[str, Any]:
    return {
        "pair": [comparison.first.name, comparison.second.name],
        "difference": _number(comparison.difference),
        "agrees": comparison.agrees,
        "score_mean": comparison.spread.mean,
        "score_deviation": comparison.spread.deviation,
        "score_kurtosis": _number(comparison.spread.kurtosis),
        "tests": [
            {
                "test": verdict.test,
                "scores": verdict.count,
                "largest": verdict.largest,
                "critical": verdict.critical,
                "catches": _number(verdict.power),
                "agrees": verdict.agrees,
            }
            for verdict in comparison.verdicts
        ],
    }


def _number(value: float) -> float | None:
    """JSON has no infinity, nor has it NaN."""
    return value if np.isfinite(value) else None
