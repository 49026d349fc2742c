"""HDR-FLIP, by its authors' package, remembered: it takes half a second a picture, more than drawing it."""

from __future__ import annotations

import contextlib
import hashlib
import json
from importlib.metadata import version
from pathlib import Path

import numpy as np
import platformdirs
from numpy.typing import NDArray

from scenes.errors import InputError
from scenes.replacing import CACHE_CURE, make_folder, replacing


def hdr_flip(test: NDArray[np.floating], reference: NDArray[np.floating]) -> float:
    """Mean HDR-FLIP (Andersson et al. 2021) at FLIP's default 67 pixels per degree, 0 to 1.

    Parameters
    ----------
    test, reference : (H, W, 3)    linear Rec.709; negative values count as 0
    """
    pair = [np.ascontiguousarray(image, np.float32) for image in (reference, test)]
    digest = hashlib.sha256(version("flip-evaluator").encode())
    for image in pair:
        digest.update(str(image.shape).encode() + image.tobytes())
    remembered = Path(platformdirs.user_cache_dir("airlight")) / "flip" / f"{digest.hexdigest()}.json"
    try:
        return float(json.loads(remembered.read_text()))
    except (OSError, ValueError, TypeError):
        value = _evaluate(*pair)
    _remember(remembered, value)
    return value


def _evaluate(reference: NDArray[np.float32], test: NDArray[np.float32]) -> float:
    import flip_evaluator

    # inputsRGB for HDR means linear Rec.709; no colour map, but the mean
    pair = np.maximum(reference, 0), np.maximum(test, 0)
    return float(flip_evaluator.evaluate(*pair, "HDR", True, False, True)[1])


def _remember(path: Path, value: float) -> None:
    """Keep the number; where the cache cannot be written it is computed again next time."""
    with contextlib.suppress(InputError):
        make_folder(path.parent, CACHE_CURE)
        with replacing(path, CACHE_CURE) as beside:
            beside.write_text(json.dumps(value))
