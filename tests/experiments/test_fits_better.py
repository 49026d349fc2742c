"""Pictures that were turned, encoded or exposed on their way are noticed, and others are not."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from experiments.fits_better import fits_better

# radiance that falls off from a light, with a shadow in it, not symmetric, some of it above white
Y, X = np.mgrid[:48, :64]
FALLOFF = 20 / (4 + (X - 20.0) ** 2 + (Y - 10.0) ** 2) + 0.02
SCENE = np.where((Y > 14) & (np.abs(X - 22) < 2 + Y / 8), 0.3, 1)[..., None] * FALLOFF[..., None] * [1, 0.8, 0.5]
DIM = np.minimum(SCENE, 1)


def encoded(image: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1."""
    return np.where(image <= 0.0031308, 12.92 * image, 1.055 * np.maximum(image, 1e-9) ** (1 / 2.4) - 0.055)


# what was done, and what is said
TURNS = {
    "upside down": lambda image: image[::-1],
    "mirrored left to right": lambda image: image[:, ::-1],
    "turned by 180 degrees": lambda image: image[::-1, ::-1],
}
SCALES = {"times 2 (+1.00 stops)": 0.5, "times 3.142 (pi)": 1 / np.pi, "times 0.07958 (1 / (4 pi))": 4 * np.pi}


@pytest.mark.parametrize("words", TURNS)
def test_a_picture_the_wrong_way_up(words: str) -> None:
    assert fits_better(TURNS[words](SCENE), SCENE).startswith(f"{words}: 0 % apart on average in place of ")


@pytest.mark.parametrize("words", SCALES)
def test_an_exposure(words: str) -> None:
    assert fits_better(SCALES[words] * SCENE, SCENE).startswith(f"{words}: ")


def test_values_for_a_screen() -> None:
    assert fits_better(encoded(DIM), DIM).startswith("decoded from sRGB to linear: ")


@pytest.mark.parametrize("darker", [0.3, 1.0])
def test_gamma_2_2_is_nearer_to_an_encoding_than_to_an_exposure(darker: float) -> None:
    image = np.minimum(darker * SCENE, 1)
    assert fits_better(image ** (1 / 2.2), image).startswith("decoded from sRGB to linear")


@pytest.mark.parametrize(("turn", "scale"), [*itertools.product(TURNS, SCALES)])
def test_several_at_once(turn: str, scale: str) -> None:
    assert fits_better(SCALES[scale] * TURNS[turn](SCENE), SCENE).startswith(f"{turn} and {scale}: ")


def test_all_at_once() -> None:
    said = fits_better(encoded(0.25 * DIM)[::-1, ::-1], DIM)
    assert said.startswith("turned by 180 degrees and decoded from sRGB to linear and times 4 (+2.00 stops): ")


def test_the_numbers_are_what_they_say() -> None:
    said = fits_better(0.5 * SCENE * (1 + 0.02 * np.sign(np.sin(7 * X)))[..., None], SCENE)
    found, now = (float(part.split(" %")[0]) for part in said.split(": ")[1].split("in place of "))
    # twice |t - r| / (|t| + |r|), of which the floor is next to nothing: 2 % after, 2 / 3 before
    assert found == pytest.approx(2, abs=0.1)
    assert now == pytest.approx(200 / 3, abs=1)


def test_noise_survives_the_hint_and_a_firefly_does_not_hide_it() -> None:
    noisy = SCENE * np.random.default_rng(3).lognormal(sigma=0.1, size=SCENE.shape)
    noisy[5, 5] = 1e6
    assert fits_better(noisy, SCENE) == ""
    assert fits_better(noisy[::-1], SCENE).startswith("upside down: ")


@pytest.mark.parametrize(
    "test",
    [
        SCENE,
        1.005 * SCENE,
        SCENE + 0.1,
        np.roll(SCENE, 3, axis=1),
        SCENE * np.random.default_rng(3).lognormal(sigma=1, size=SCENE.shape),
        np.zeros_like(SCENE),
        np.where(X[..., None] < 32, SCENE, 0),
    ],
)
def test_what_nothing_would_mend_is_left_alone(test: np.ndarray) -> None:
    assert fits_better(test, SCENE) == ""


def test_a_symmetric_scene_is_no_way_up() -> None:
    both = SCENE + SCENE[::-1]
    assert fits_better(both[::-1], both) == ""
    assert fits_better(2 * both[::-1], both).startswith("times 0.5")


def test_a_black_reference() -> None:
    assert fits_better(SCENE, np.zeros_like(SCENE)) == ""
