"""Entries for tests of the cache."""

from __future__ import annotations

import os
import time
from importlib.metadata import version
from pathlib import Path

import numpy as np

from reference import cache
from reference.estimators import Equiangular

RECIPE = {
    "scene": "abc",
    "size": [4, 3],
    "estimator": Equiangular.name,
    "estimator_version": Equiangular.version,
    "variant": "llvm_ad_rgb",
    "mitsuba": version("mitsuba"),
    "drjit": version("drjit"),
}
ARRAYS = {
    "mean.scattering": np.random.default_rng(3).normal(size=(3, 4, 3)),
    "image_mean.scattering": np.array([np.inf, -0.0, np.nan]),
}
RECORD = {
    "scene_name": "fog",
    "parameters": {"g": "0.6"},
    "goal": {"rel_error": 0.1},
    "rel_error": 0.09,
    "passes": 32,
    "finished": True,
}


def stored(recipe: dict) -> Path:
    """Store ARRAYS and RECORD; where they are."""
    cache.store(recipe, ARRAYS, RECORD)
    return cache.folder() / f"{cache.key(recipe)}.npz"


def age(path: Path, days: float) -> None:
    """Make a file look as if it had last been used so many days ago."""
    then = time.time() - 86400 * days
    os.utime(path, (then, then))


def names() -> set[str]:
    """What lies in the folder."""
    return {path.name for path in cache.folder().iterdir()}
