"""The tile of blue noise: the same everywhere, each value once, and without low frequencies."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest

from gpu_impl.visibilities.blue_noise import SEED, SIZE, blue_noise
from gpu_impl.visibilities.void_and_cluster import void_and_cluster


def power(tile: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Frequency [1 / pixel] and power of a tile, over that of white noise of the same variance."""
    frequency = np.fft.fftfreq(len(tile))
    spectrum = np.abs(np.fft.fft2(tile - tile.mean())) ** 2 / tile.var() / tile.size
    return np.hypot(frequency[:, None], frequency), spectrum


def test_it_is_the_same_everywhere() -> None:
    ranks = void_and_cluster(SIZE, SEED)
    assert hashlib.sha256(ranks.astype("<i8").tobytes()).hexdigest()[:16] == "63e898dc4a7cfbee"
    np.testing.assert_array_equal(blue_noise(), ((ranks + 0.5) / SIZE**2).astype(np.float32))


@pytest.mark.parametrize(("size", "seed"), [(4, 0), (9, 1), (32, 2)])
def test_each_rank_is_there_once(size: int, seed: int) -> None:
    assert sorted(void_and_cluster(size, seed).ravel()) == list(range(size * size))


def test_low_frequencies_are_missing() -> None:
    frequency, spectrum = power(blue_noise())
    # measured: 2.5e-4 below an eighth, 1.1e-2 from there to a quarter, 1.24 above; white noise has 1 everywhere
    assert spectrum[frequency < 1 / 8].mean() < 1e-3
    assert spectrum[(frequency >= 1 / 8) & (frequency < 1 / 4)].mean() < 3e-2
    assert spectrum[frequency > 1 / 4].mean() > 1.1


@pytest.mark.parametrize("share", [0.05, 0.25, 0.5, 0.8])
def test_the_first_are_spread_evenly_however_many_they_are(share: float) -> None:
    frequency, spectrum = power((blue_noise() < share).astype(float))
    # points that are apart by d have little power far below 1 / d; measured: 0.064, 0.040, 0.059 and 0.041, and at
    # least 0.9 for as many points at random
    reach = 0.35 * np.sqrt(min(share, 1 - share))
    assert spectrum[(frequency > 0) & (frequency < reach)].mean() < 0.1


def test_a_tile_that_is_too_small_is_refused() -> None:
    with pytest.raises(ValueError, match="size must be 4 or more"):
        void_and_cluster(3, 0)
