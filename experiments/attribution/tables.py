"""The numbers of an attribution: rows for results.csv and results.parquet, and an object for results.json."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from experiments.attribution.coalitions import PARTS
from experiments.attribution.measurement import Attribution
from experiments.attribution.split import Share
from experiments.provenance import TECHNIQUE_KEYS

# what is no part, and stands in the same tables
WHOLE, REMAINS = "whole", "remains"
Row = dict[str, Any]


def settings(found: Attribution) -> dict[str, Any]:
    """The technique's fields, called as in all tables of results."""
    technique = found.technique
    return {
        TECHNIQUE_KEYS.get(field.name, field.name): getattr(technique, field.name) for field in fields(technique)
    }


def shares(found: Attribution) -> dict[str, Share]:
    """The whole error, its parts and what remains, by name."""
    return {WHOLE: found.split.whole, **found.split.parts, REMAINS: found.split.remains}


def rows(found: Attribution) -> list[Row]:
    """A row for the whole error, for each of the five parts, and for what remains.

    squared_error, standard_error    Shapley value of the mean squared error [radiance^2]; empty for a part left out
    of_whole                         the same as a fraction of the whole; empty where that is noise
    image_mean                       mean of the signed map over the reference's mean: what the part does to it
    rms                              root mean square of the signed map over the reference's mean
    """
    mean = float(np.mean(found.reference))
    about, there, lines = settings(found), shares(found), []
    for name in (WHOLE, *PARTS, REMAINS):
        share = there.get(name)
        numbers: Row = dict.fromkeys(("squared_error", "standard_error", "of_whole", "image_mean", "rms"))
        if share is not None:
            of_whole = found.split.of_whole(share)
            numbers = {
                "squared_error": share.value,
                "standard_error": share.standard_error,
                "of_whole": None if np.isnan(of_whole) else of_whole,
                "image_mean": float(np.mean(share.signed)) / mean,
                "rms": float(np.sqrt(np.mean(share.signed**2))) / mean,
            }
        lines.append({**about, "part": name, **numbers, "left_out": found.parts.left_out.get(name, "")})
    return lines


def as_object(found: Attribution) -> dict[str, Any]:
    """Everything of one technique, the worth of each coalition too, named by what it replaces."""
    numbers = {
        row["part"]: {key: row[key] for key in ("squared_error", "standard_error", "of_whole", "image_mean", "rms")}
        for row in rows(found)
        if not row["left_out"]
    }
    left = {
        " + ".join(part for part in PARTS if part in coalition): value for coalition, value in found.split.left.items()
    }
    return {
        "technique": settings(found),
        **numbers,
        "left_out": found.parts.left_out,
        "squared_error_with_exact": left,
    }
