"""The numbers of an attribution: rows for results.csv and results.parquet, and an object for results.json."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from experiments.attribution.coalitions import PARTS
from experiments.attribution.measurement import Attribution
from experiments.attribution.pictures import OTHER_SURFACE
from experiments.attribution.split import Share
from experiments.provenance import describe_technique

# what is no part, and stands in the same tables
WHOLE, TOGETHER, REMAINS = "whole", "parts together", "remains"
NUMBERS = ("squared_error", "standard_error", "of_parts", "of_mean", "image_mean", "rms", "in_other_surfaces")
Row = dict[str, Any]


def percent(fraction: float) -> str:
    """A fraction in per cent; NaN is what cannot be told from noise."""
    return "noise" if np.isnan(fraction) else f"{fraction:.2%}"


def shares(found: Attribution) -> dict[str, Share]:
    """The whole error, its parts, what they are together and what remains, by name."""
    split = found.split
    return {WHOLE: split.whole, **split.parts, TOGETHER: split.together, REMAINS: split.remains}


def told_rms(found: Attribution, share: Share) -> str:
    """Root of a squared error over the reference's mean, in words; below three standard errors it is a bound."""
    if share.is_noise:
        return f"< {np.sqrt(3 * share.standard_error) / np.mean(found.reference):.2%}"
    return f"{found.of_mean(share):.3%}"


def other_surfaces(found: Sequence[Attribution]) -> str:
    """Where OpenGL and the reference see different surfaces, and what that has of each technique's error; in words."""
    where = found[0].other_surfaces
    what = f"OpenGL and the reference see surfaces whose distances differ by more than {OTHER_SURFACE:.0%}"
    if not where.any():
        return f"In none of the {where.size} pixels {what}."
    shares = ", ".join(f"{one.label} {percent(one.in_other_surfaces)}" for one in found)
    return (
        f"In {where.sum()} of {where.size} pixels {what}, as at silhouettes. The exact combination ends there where "
        "OpenGL does, so that what this costs stands in what remains. These pixels' part of the squared error: "
        f"{shares}."
    )


def rows(found: Attribution) -> list[Row]:
    """A row for the whole error, for each of the five parts, for those together, and for what remains.

    squared_error, standard_error    Shapley value of the mean squared error [radiance^2]; empty for a part left out
    of_parts                         the same over that of the parts together; empty where that is noise
    of_mean                          root of the squared error over the reference's mean, with the square's sign
    image_mean                       mean of the signed map over the reference's mean: what the part does to it
    rms                              root mean square of the signed map over the reference's mean
    in_other_surfaces                how much of the whole squared error lies in pixels in which OpenGL sees another
                                     surface than the reference does; for the whole alone, empty where that is noise
    """
    mean = float(np.mean(found.reference))
    about, there, lines = describe_technique(found.technique), shares(found), []
    for name in (WHOLE, *PARTS, TOGETHER, REMAINS):
        numbers: Row = dict.fromkeys(NUMBERS)
        if name in there:
            share = there[name]
            fraction = found.split.fraction(share)
            values = (
                share.value,
                share.standard_error,
                None if np.isnan(fraction) else fraction,
                found.of_mean(share),
                float(np.mean(share.signed)) / mean,
                float(np.sqrt(np.mean(share.signed**2))) / mean,
                None if name != WHOLE or np.isnan(found.in_other_surfaces) else found.in_other_surfaces,
            )
            numbers = dict(zip(NUMBERS, values, strict=True))
        lines.append({**about, "part": name, **numbers, "left_out": found.parts.left_out.get(name, "")})
    return lines


def as_object(found: Attribution) -> dict[str, Any]:
    """Everything of one technique, the worth of each coalition too, named by what it replaces."""
    numbers = {row["part"]: {key: row[key] for key in NUMBERS} for row in rows(found) if not row["left_out"]}
    left = {
        " + ".join(part for part in PARTS if part in coalition): value for coalition, value in found.split.left.items()
    }
    return {
        "technique": describe_technique(found.technique),
        **numbers,
        "left_out": found.parts.left_out,
        "pixels_of_other_surfaces": int(found.other_surfaces.sum()),
        "squared_error_with_exact": left,
    }
