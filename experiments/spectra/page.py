"""`airlight spectra`: what three bands get wrong, as a table, a figure and a page."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analytic import spectra
from experiments.pages import made_by, prepare_page
from experiments.provenance import environment, package_version
from experiments.spectra.errors import (
    COEFFICIENTS,
    DEPTHS,
    MEDIA,
    ONE_PHASE,
    QUANTITIES,
    SAMPLED,
    Case,
    Row,
    measure_medium,
    select,
)
from experiments.spectra.figure import draw
from scenes.errors import InputError
from scenes.replacing import replacing

TITLE = "Three bands against the spectrum"
COMMAND = "airlight spectra --out results/spectra"
VERSIONS = ("numpy", "colour-science", "miepython")
SHOWN = (0, 4, 6, 8)  # depths 0.1, 1, 3.2 and 10 of the tables


def write_spectra(folder: Path, cases: Mapping[str, Case] = MEDIA) -> list[Row]:
    """Measure the media; write results.csv, errors.png and README.md.

    Parameters
    ----------
    folder : made where it is missing
    cases : what to measure

    Returns
    -------
    rows : what results.csv holds

    Raises
    ------
    InputError
        The folder cannot be written, or miepython is missing.
    """
    import polars

    prepare_page(folder, TITLE)
    try:
        media = {name: case.make() for name, case in cases.items()}
    except ModuleNotFoundError as error:
        raise InputError(str(error)) from None
    made = _provenance()
    rows = [row | made for name, medium in media.items() for row in measure_medium(name, medium)]
    with replacing(folder / "results.csv") as beside:
        polars.DataFrame(rows).write_csv(beside)
    with replacing(folder / "errors.png") as beside:
        draw(beside, rows)
    with replacing(folder / "README.md") as beside:
        beside.write_text(page(rows, cases, media), encoding="utf-8")
    return rows


def _provenance() -> Row:
    known = environment()
    return {
        "command": COMMAND,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        **{key: known[key] for key in ("commit", "airlight", "python")},
        **{name: package_version(name) for name in VERSIONS},
    }


def page(rows: list[Row], cases: Mapping[str, Case], media: Mapping[str, spectra.SpectralMedium]) -> str:
    """The README of the results: every number in it is one of `rows` or made from `media`."""
    errors = [
        "| medium | depth | T: red | green | blue | Delta E | L: red | green | blue | Delta E |",
        "|---" * 10 + "|",
    ]
    choices = ["| medium | depth | mean | matched | sampled | mean, one phase function |", "|---" * 6 + "|"]
    coefficients = ["| medium | unit | optical depth 1 at | sigma_t: mean | matched | sampled |", "|---" * 6 + "|"]
    for name, case in cases.items():
        distance = select(rows, "distance", medium=name, coefficients="mean", quantity="airlight")
        unit_depth = distance[SHOWN[1]]
        columns = (media[name].medium().sigma_t, media[name].medium(float(unit_depth)).sigma_t)
        sampled = media[name].sigma_t[SAMPLED]
        cells = (_triple(bands) for bands in (*columns, sampled))
        coefficients.append(f"| {name} | {case.unit} | {unit_depth:.3g} {case.unit} | {' | '.join(cells)} |")
        for depth in SHOWN:
            errors.append(f"| {name} | {DEPTHS[depth]:.2g} | {' | '.join(_errors(rows, name, depth))} |")
            kinds = [{"coefficients": choice, "quantity": "airlight"} for choice in COEFFICIENTS]
            found = [select(rows, "delta_e", medium=name, **kind) for kind in [*kinds, {"quantity": ONE_PHASE}]]
            shown = (f"{values[depth]:.2f}" if values.size else "the same" for values in found)
            choices.append(f"| {name} | {DEPTHS[depth]:.2g} | {' | '.join(shown)} |")
    lobes = (f"{-np.minimum(row, 0).sum() / np.maximum(row, 0).sum():.0%}" for row in spectra.responses())
    return PAGE.format(
        title=TITLE,
        made=made_by(COMMAND, *VERSIONS),
        media="\n".join(f"- **{name}**: {case.what}." for name, case in cases.items()),
        lobes=", ".join(f"{share} in {channel}" for share, channel in zip(lobes, spectra.CHANNELS, strict=True)),
        coefficients="\n".join(coefficients),
        errors="\n".join(errors),
        choices="\n".join(choices),
    )


def _errors(rows: list[Row], medium: str, depth: int) -> list[str]:
    cells = []
    for quantity in QUANTITIES:
        where = {"medium": medium, "coefficients": "mean", "quantity": quantity}
        for channel in spectra.CHANNELS:
            inside = select(rows, f"spectral_{channel}", **where)[depth] > 0
            relative = 100 * select(rows, f"relative_{channel}", **where)[depth]
            cells.append(f"{relative:+.2f} %" if inside else "outside")
        cells.append(f"{select(rows, 'delta_e', **where)[depth]:.2f}")
    return cells


def _triple(bands: NDArray[np.float64]) -> str:
    return " ".join(f"{value:.4g}" for value in bands)


PAGE = """\
# {title}

{made}
Every row of [results.csv](results.csv) carries this.

A renderer that works in linear Rec.709 gives a medium three coefficients and one phase function. Here the same light
is integrated over the spectrum, from 380 to 780 nm in steps of 5 nm with each wavelength's own coefficients and phase
function, and projected to linear Rec.709 at the end. The light has the spectrum of D65, which is white.

{media}

The eye looks past a light at distance D, 30 degrees off its ray; the ray is followed for 2 D, and D runs so that the
optical depth to the light at 550 nm goes from 0.1 to 10. T is the transmittance of the distance D, seen against the
light itself as white. L is the airlight of the ray, seen in a picture that is exposed for it: D65 white has its
luminance. Delta E is CIE Delta E 2000; 1 is just visible. "outside": the spectral result has no light in that channel,
its colour lies outside Rec.709, and no three coefficients can be right.

## Three coefficients

- **mean**: response-weighted mean, right for thin media to the first order; what `SpectralMedium.medium()` gives.
- **matched**: right over the distance of optical depth 1, `medium(distance=...)`.
- **sampled**: the spectrum at 680, 550 and 440 nm, where Bruneton and Neyret 2008 take that of air.

Red, green and blue, in 1/unit:

{coefficients}

## Error of the mean

{errors}

![Errors by channel and Delta E over the optical depth](errors.png)

Lines of the upper two rows have the channels' colours, and end where the spectral result leaves Rec.709.

## Delta E of the airlight, by choice of coefficients

The last column gives the spectral side one phase function too: what is left is the coefficients' error, and the
difference is what the phase function's change with wavelength costs.

{choices}

## What is seen, and why

- Thin media are right with the mean, whatever their spectrum, where the phase function is the same for all wavelengths:
  that is how it is derived (`analytic/spectra/bands.py`). The next order is the spread of the coefficient within a
  channel's response, so the transmittance of **fog**, which is nearly grey, stays right at every depth, and **air**,
  the most coloured, is the first to go wrong.
- Deep media go wrong because light lasts longest where the medium is clearest: the spectrum narrows, and its colour
  leaves Rec.709. There the relative error of a channel has lost its meaning and Delta E counts; for transmittance
  Delta E falls again with depth because hardly any light is left to see.
- The responses have negative lobes (against their positive parts: {lobes}),
  so the error of a channel may have either sign. With positive weights the mean's transmittance would always be too
  dark: light would be left where the medium is clearer than the mean, and more than three bands know.
- In **haze** the coefficients are not what errs at small depths: small particles scatter red light more evenly than
  blue, and one phase function cannot say so. In **fog** what little error there is comes from there too.
- Matching at a distance makes that distance right at the cost of thinner media. Sampling ignores all but three
  wavelengths of a channel's response, so it is wrong for thin media already.
"""
