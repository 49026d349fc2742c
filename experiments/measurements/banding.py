"""Bands and noise in the error: its spectrum along and across the light's shafts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from experiments.flip import LUMINANCE
from experiments.measurements import Measurement, Value
from experiments.measurements.shafts import shaft_direction, vanishing_point
from experiments.measurements.shot import Shot
from experiments.metrics import signed_relative_error
from reference.brightness import darkest

Array = NDArray[np.float64]

# the longest period of each octave of the spectrum [pixel]; the first has all that is shorter too
OCTAVES = (4, 8, 16, 32, 64)
# Waves longer than this are seen as bands, shorter ones as grain [pixel]: at the distance at which a pixel subtends
# 1/60 degree, 8 of them are 7.5 cycles a degree, behind which the eye's sensitivity falls (Campbell and Robson 1968).
COARSE = 8
# Spectra are taken of windows, in which shafts are nearly parallel. Nothing is resampled, which would blur the noise.
WINDOW = 128
# An error's mean square counts from so many standard deviations on above what noise of the reference leaves of one.
SURE = 3.0


@dataclass(frozen=True)
class Spectrum:
    """Mean squares of the parts of an error: those of the octaves add up to that of the whole, without its slow trend.

    Attributes
    ----------
    along, across : (octaves,)    of waves that run along the shafts, as rings around the light do, and across them;
                                  a wave counts for that of the two to which it is nearer
    period : float                of the strongest wave [pixel], that of a bin: the next ones' frequencies are 1 / side
                                  of a window away, so that one of p stands for p^2 / (2 side) more or less; infinite
                                  where there is none
    """

    along: Array
    across: Array
    period: float


def spectrum(error: Array, lit: NDArray[np.bool_], vanishing: Array, noise: Array | None = None) -> Spectrum | None:
    """Take an error apart into waves by their periods and by their way across the shafts.

    Means over windows of `WINDOW` pixels a side (the picture's shorter side, where that is less) that overlap by
    half, under a Hann window (Welch 1967), each with its trend, a plane, taken away. Windows over the vanishing point
    are left out: shafts run there in all directions. The Hann window blurs the edge of the longest octave: of waves of
    48 pixels 98 % of the mean square count, of 64 76 %, of 80 47 %, of 128 11 % and of 256 1 %, in windows of 128.

    Parameters
    ----------
    error : (H, W)
    lit : (H, W)         where it means something
    vanishing : (3,)     of the shafts, as `vanishing_point` gives it
    noise : (H, W)       standard error of `error`, which is white and taken away; None for none

    Returns
    -------
    Spectrum or None
        NaN in octaves longer than half a window; None where no window holds light, or where `noise` alone may be all
        that there is: where its mean square is not exceeded by `SURE` standard deviations.
    """
    side = min(WINDOW, *error.shape)
    # the sampled Hann window without its zeros
    hann = np.sin(np.pi * (np.arange(side) + 0.5) / side) ** 2
    taper = np.outer(hann, hann)
    frequency = np.fft.fftfreq(side)
    fy, fx = np.meshgrid(frequency, frequency, indexing="ij")
    power = {"along": np.zeros_like(taper), "across": np.zeros_like(taper)}
    weight = np.zeros(error.shape)
    for rows, columns in _windows(error.shape, side):
        middle = np.array([columns.start, rows.start]) + 0.5 * (side - 1)
        direction, distance = shaft_direction(vanishing, *middle)
        seen = lit[rows, columns]
        if distance < side / 2 or not seen.any():
            continue
        found = np.abs(np.fft.fft2(taper * _without_trend(error[rows, columns], taper, seen))) ** 2 / side**2
        runs_along = np.abs(fx * direction[0] + fy * direction[1]) >= np.abs(fx * direction[1] - fy * direction[0])
        power["along"] += np.where(runs_along, found, 0)
        power["across"] += np.where(runs_along, 0, found)
        weight[rows, columns] += np.where(seen, taper**2, 0)
    whole = float(weight.sum())
    if not whole:
        return None
    # what noise adds to all bins together, the same to each, and its variance for Gaussian noise
    squares = np.zeros_like(error) if noise is None else weight * noise**2
    white, variance = float(squares.sum()), 2 * float((squares**2).sum())
    length = np.hypot(fx, fy)
    edges = [np.inf, *(1 / np.array(OCTAVES))]
    octaves = [(length < short) & (length >= long) for short, long in pairwise(edges)]
    has_room = np.array(OCTAVES) <= side / 2
    # by symmetry half of a white spectrum runs either way
    rests = {
        way: np.array([found[octave].sum() - white / side**2 * octave.sum() / 2 for octave in octaves])
        for way, found in power.items()
    }
    if sum(rest[has_room].sum() for rest in rests.values()) < SURE * np.sqrt(variance):
        return None
    parts = {way: np.where(has_room, np.maximum(rest, 0) / whole, np.nan) for way, rest in rests.items()}
    both = np.where(length >= 2 / side, power["along"] + power["across"], 0)
    strongest = length.flat[np.argmax(both)]
    return Spectrum(**parts, period=float(1 / strongest) if strongest else float("inf"))


def _windows(shape: tuple[int, ...], side: int) -> Iterator[tuple[slice, slice]]:
    """Squares that cover a picture, each over half of the one before."""
    starts = [np.linspace(0, n - side, -(-2 * (n - side) // side) + 1).round().astype(int) for n in shape]
    for top in starts[0]:
        for left in starts[1]:
            yield slice(top, top + side), slice(left, left + side)


def _without_trend(error: Array, taper: Array, seen: NDArray[np.bool_]) -> Array:
    """The error less the plane that is nearest to it where it is seen, 0 elsewhere."""
    rows, columns = np.nonzero(seen)
    plane = np.stack([np.ones(len(rows)), rows, columns], axis=1)
    weight = taper[seen]
    coefficients = np.linalg.lstsq(plane * weight[:, None], error[seen] * weight, rcond=None)[0]
    rest = np.zeros_like(error)
    rest[seen] = error[seen] - plane @ coefficients
    return rest


def banding(shot: Shot) -> dict[str, Value]:
    """The spectrum of the signed relative error of the scattering layer's luminance.

    Shafts are those of the scene's first light. The reference's own noise is taken away. Columns, all None where
    nothing is lit or the reference's noise may be all of the error, octaves also where the picture is too small for
    them:

    banding.rms                the error without its slow trend, root mean square [relative]
    banding.along, .across     its waves of `COARSE` to 64 pixels that run along the shafts (bands across them, as a
                               regular march leaves) and across them (streaks), root mean square [relative]
    banding.coarse_share       share of both in the mean square: 0.048 for white noise in windows of 128 pixels, 0.045
                               of 64, 0.035 of 32; less for blue noise, nearly 1 for bands
    banding.period             of the strongest wave [pixel], in the steps of `Spectrum.period`
    banding.along_4px, ...     waves up to 4 pixels, of 4 to 8, ... up to 64, root mean square [relative]
    banding.across_4px, ...    likewise
    """
    test, truth, deviation = (
        np.asarray(image, np.float64) @ LUMINANCE
        for image in (shot.frame.scattering, shot.reference.scattering, shot.reference.standard_error("scattering"))
    )
    found = None
    if (truth > 0).any():
        vanishing = vanishing_point(shot.scene.camera, shot.scene.lights[0])
        # a sample's channels share its path: their errors go together, and add up as they are
        noise = deviation / np.maximum(truth, darkest(truth))
        found = spectrum(signed_relative_error(test, truth), (test > 0) | (truth > 0), vanishing, noise)
    return columns(found)


def columns(found: Spectrum | None) -> dict[str, Value]:
    """A spectrum as `banding` says."""
    names = [f"{way}_{octave}px" for way in ("along", "across") for octave in OCTAVES]
    if found is None:
        return {f"banding.{name}": None for name in ("rms", "along", "across", "coarse_share", "period", *names)}
    coarse = np.array(OCTAVES) > COARSE
    along, across = np.nansum(found.along[coarse]), np.nansum(found.across[coarse])
    whole = np.nansum(found.along) + np.nansum(found.across)
    octaves = np.sqrt(np.concatenate([found.along, found.across]))
    return {
        "banding.rms": float(np.sqrt(whole)),
        "banding.along": float(np.sqrt(along)),
        "banding.across": float(np.sqrt(across)),
        "banding.coarse_share": float((along + across) / whole) if whole > 0 else None,
        "banding.period": found.period if whole > 0 else None,
        **{f"banding.{name}": None if np.isnan(rms) else float(rms) for name, rms in zip(names, octaves, strict=True)},
    }


MEASUREMENT = Measurement(banding)
