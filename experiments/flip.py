"""HDR-FLIP, by its authors' package, remembered: it takes half a second a picture, more than drawing it."""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
from importlib.metadata import version
from pathlib import Path

import numpy as np
import platformdirs
from numpy.typing import NDArray

from scenes.errors import InputError
from scenes.replacing import CACHE_CURE, make_folder, replacing

# Radiance that FLIP's tone mapper, Hill's fit of ACES, shows at 85 % of white: FLIP's exposures run from the one that
# gives it to the reference's brightest pixel to the one that gives it to the median (Andersson et al. 2021, section 3).
SHOWN_BRIGHT = 2.118873
# FLIP computes in float32, and the median cannot be farther below the brightest pixel than float32 resolves
RESOLVED = float(np.finfo(np.float32).eps)
# white at any of FLIP's exposures, and its tone mapper can still square it
WHITE = 2.0**30
# of linear Rec.709
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def hdr_flip(test: NDArray[np.floating], reference: NDArray[np.floating]) -> float:
    """Mean HDR-FLIP (Andersson et al. 2021) at FLIP's default 67 pixels per degree, 0 to 1.

    Its exposures are set by the reference's lit pixels. Where none is black that is FLIP as its authors have it; a
    picture that is mostly black has a median of 0, for which theirs takes 23 exposures, most of them white all over.

    Parameters
    ----------
    test, reference : (H, W, 3)    linear Rec.709; negative values count as 0
    """
    pair = _at_unit_brightness(reference, test)
    exposures = _exposures(pair[0])
    digest = hashlib.sha256(f"{version('flip-evaluator')} {exposures}".encode())
    for image in pair:
        digest.update(str(image.shape).encode() + image.tobytes())
    remembered = Path(platformdirs.user_cache_dir("airlight")) / "flip" / f"{digest.hexdigest()}.json"
    try:
        return float(json.loads(remembered.read_text()))
    except (OSError, ValueError, TypeError, RecursionError):
        value = _evaluate(*pair, exposures)
    _remember(remembered, value)
    return value


def _at_unit_brightness(
    reference: NDArray[np.floating], test: NDArray[np.floating]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Both times the power of two that brings the reference's maximum to 0.5 .. 1.

    FLIP does not see the unit of radiance, but its program takes a reference below float32's epsilon for black, and
    ends the process.
    """
    exponent = int(np.frexp(np.max(reference))[1])

    def scaled(image: NDArray[np.floating]) -> NDArray[np.float32]:
        large = np.clip(np.ldexp(np.asarray(image, np.float64), -exponent), 0, WHITE)
        return np.ascontiguousarray(large, np.float32)

    return scaled(reference), scaled(test)


def _exposures(reference: NDArray[np.float32]) -> dict[str, float]:
    """FLIP's first and last exposure, in stops, of its median over the pixels that are not black."""
    luminance = np.sort((reference @ LUMINANCE.astype(np.float32)).ravel())
    lit = luminance[luminance > 0]
    # the upper of two medians, as FLIP has it
    brightest, median = (max(float(lit[place]), RESOLVED) if lit.size else 1.0 for place in (-1, lit.size // 2))
    return {name: math.log2(SHOWN_BRIGHT / y) for name, y in (("startExposure", brightest), ("stopExposure", median))}


def _evaluate(reference: NDArray[np.float32], test: NDArray[np.float32], exposures: dict[str, float]) -> float:
    import flip_evaluator

    # inputsRGB for HDR means linear Rec.709; no colour map, but the mean
    return float(flip_evaluator.evaluate(reference, test, "HDR", True, False, True, exposures)[1])


def _remember(path: Path, value: float) -> None:
    """Keep the number; where the cache cannot be written it is computed again next time."""
    with contextlib.suppress(InputError):
        make_folder(path.parent, CACHE_CURE)
        with replacing(path, CACHE_CURE) as beside:
            beside.write_text(json.dumps(value))
