"""Shapley values against games with known answers and against all orders; the split's noise against simulation."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from experiments.attribution.shapley import coalitions, shapley
from experiments.attribution.split import Share, Split, split

PARTS = ("a", "b", "c", "d")
SHAPE = (16, 12, 3)


def random_game(seed: int = 1) -> dict[frozenset[str], float]:
    random = np.random.default_rng(seed)
    return {coalition: float(random.normal()) for coalition in coalitions(PARTS)}


def shares(found: Split) -> dict[str, Share]:
    return {**found.parts, "together": found.together, "whole": found.whole, "remains": found.remains}


def test_coalitions_are_all_sets_from_nothing_to_everything() -> None:
    found = coalitions(PARTS)
    assert len(found) == len(set(found)) == 16
    assert found[0] == frozenset()
    assert found[-1] == frozenset(PARTS)
    assert coalitions(()) == [frozenset()]


def test_the_glove_game() -> None:
    # one left glove, two right ones; a pair is worth 1: Shapley gives 4/6, 1/6, 1/6
    players = ("left", "right", "other right")
    worth = {one: 1.0 - ("left" in one and len(one) > 1) for one in coalitions(players)}
    found = shapley(players, worth)
    assert found == pytest.approx({"left": 4 / 6, "right": 1 / 6, "other right": 1 / 6}, abs=1e-15)


def test_the_mean_over_all_orders() -> None:
    worth = random_game()
    expected = dict.fromkeys(PARTS, 0.0)
    orders = list(permutations(PARTS))
    for order in orders:
        for place, part in enumerate(order):
            expected[part] += (worth[frozenset(order[:place])] - worth[frozenset(order[: place + 1])]) / len(orders)
    # measured: 6e-17
    assert shapley(PARTS, worth) == pytest.approx(expected, abs=1e-15)


def test_values_add_up() -> None:
    worth = random_game()
    total = worth[frozenset()] - worth[frozenset(PARTS)]
    # measured: 0
    assert sum(shapley(PARTS, worth).values()) == pytest.approx(total, abs=1e-15)


def test_a_part_that_changes_nothing_gets_nothing() -> None:
    game = random_game()
    worth = {one: game[one - {"c"}] for one in coalitions(PARTS)}
    assert shapley(PARTS, worth)["c"] == 0


def test_parts_that_change_the_same_get_the_same() -> None:
    def game(one: frozenset[str]) -> float:
        both = len(one & {"a", "b"})
        return both**2 + 3.0 * ("c" in one) * (both > 0)

    worth = {one: game(one) for one in coalitions(PARTS)}
    found = shapley(PARTS, worth)
    assert found["a"] == pytest.approx(found["b"], abs=1e-15)
    assert found["a"] != pytest.approx(found["c"], abs=0.1)


def test_arrays_are_shared_out_value_by_value() -> None:
    games = random_game(1), random_game(2)
    found = shapley(PARTS, {one: np.array([game[one] for game in games]) for one in coalitions(PARTS)})
    for number, game in enumerate(games):
        for part, value in shapley(PARTS, game).items():
            assert found[part][number] == pytest.approx(value, abs=1e-15)


def test_what_it_cannot_take() -> None:
    worth = random_game()
    with pytest.raises(ValueError, match="parts must be different"):
        shapley(("a", "a"), worth)
    del worth[frozenset("ab")]
    with pytest.raises(ValueError, match=r"worth must have every coalition, and lacks \['a', 'b'\]"):
        shapley(PARTS, worth)


def pictures(seed: int = 3, channels: int = 3) -> tuple[np.ndarray, dict[frozenset[str], np.ndarray]]:
    """A true image, and pictures whose errors are products of what each part does: no coalition is the sum of others.

    With one channel all three are alike.
    """
    random = np.random.default_rng(seed)
    truth = random.uniform(1, 2, (*SHAPE[:2], channels)) * np.ones(SHAPE)
    factors = {part: 1 + 0.05 * random.normal(size=(*SHAPE[:2], channels)) for part in PARTS}
    return truth, {
        one: truth * np.prod([factors[part] for part in PARTS if part not in one], axis=0) for one in coalitions(PARTS)
    }


def test_parts_and_what_remains_are_the_whole() -> None:
    truth, drawn = pictures()
    reference = truth + 0.01
    found = split(PARTS, drawn, reference, np.full(SHAPE, 0.02))
    parts = list(found.parts.values())
    # measured: 5e-19 and 2e-16
    assert sum(share.value for share in parts) + found.remains.value == pytest.approx(found.whole.value, abs=1e-17)
    signed = sum(share.signed for share in parts) + found.remains.signed
    np.testing.assert_allclose(signed, found.whole.signed, rtol=0, atol=1e-15)
    np.testing.assert_allclose(found.whole.signed, drawn[frozenset()] - reference, rtol=0, atol=0)
    assert found.whole.value == pytest.approx(np.mean((drawn[frozenset()] - reference) ** 2) - 0.02**2, rel=1e-12)


def test_a_reference_without_noise_leaves_nothing_to_subtract() -> None:
    truth, drawn = pictures()
    off = np.random.default_rng(9).uniform(-1e-3, 1e-3, SHAPE)
    found, exact = (split(PARTS, drawn, one, np.full(SHAPE, 1e-3), is_bound=True) for one in (truth + off, truth))
    # the last coalition is the truth itself
    assert exact.remains.value == 0
    assert found.remains.value == pytest.approx(np.mean(off**2), rel=1e-12)
    for name, share in shares(found).items():
        assert abs(share.value - shares(exact)[name].value) <= share.standard_error
    # all off by as much, and the same way, as can be
    worst = split(PARTS, drawn, truth - 1e-3 * np.sign(found.whole.signed), np.full(SHAPE, 1e-3), is_bound=True)
    assert worst.whole.value - exact.whole.value > 0.9 * exact.whole.standard_error


def test_pictures_of_another_size_are_refused() -> None:
    truth, drawn = pictures()
    with pytest.raises(ValueError, match="pictures must have the reference's shape"):
        split(PARTS, drawn, truth[1:], truth[1:])


@pytest.mark.parametrize("channels", [1, 3])
def test_standard_errors_are_what_the_noise_does(channels: int) -> None:
    # one: grey fog, in which a path lights all channels alike; three: channels with noise of their own
    truth, drawn = pictures(channels=channels)
    random = np.random.default_rng(5)
    draws, passes = 1500, 8
    size = (*SHAPE[:2], channels)
    deviation = random.uniform(0.05, 0.3, size) * np.ones(SHAPE)
    told, exact = split(PARTS, drawn, truth, deviation), split(PARTS, drawn, truth, np.zeros(SHAPE))
    values: dict[str, list[float]] = {part: [] for part in (*PARTS, "together", "whole", "remains")}
    errors: dict[str, list[float]] = {"whole": [], "remains": []}
    for _ in range(draws):
        noise = random.normal(size=(passes, *size)) * deviation * np.sqrt(passes)
        found = split(PARTS, drawn, truth + noise.mean(axis=0), noise.std(axis=0, ddof=1) / np.sqrt(passes))
        for name, share in shares(found).items():
            values[name].append(share.value)
            if name in errors:
                errors[name].append(share.standard_error)
    for name, drawn_values in values.items():
        spread = float(np.std(drawn_values))
        # no bias: the mean of the draws is within four of its own standard errors of what there is without noise
        assert abs(np.mean(drawn_values) - shares(exact)[name].value) < 4 * spread / np.sqrt(draws)
        error = shares(told)[name].standard_error
        if name in errors:
            error = float(np.sqrt(np.mean(np.square(errors[name]))))
        if channels == 3:
            # a bound: never too small, and at most sqrt(3) too large for the parts, whose channels' noise is linear
            assert 0.93 * spread < error < 1.9 * spread
        elif name in errors:
            # 4 s^4 counted, and 2 s^4 (1 + 1 / 7) there where nothing else is
            assert 0.93 * spread < error < 1.07 * np.sqrt(4 / (2 + 2 / 7)) * spread
        else:
            # 1500 draws know a standard deviation to 1.8 %
            assert error == pytest.approx(spread, rel=0.07)


def test_parts_are_known_where_the_whole_is_noise() -> None:
    truth, drawn = pictures(channels=1)
    near = {one: truth + 0.2 * (drawn[one] - truth) for one in drawn}
    noise = np.random.default_rng(7).normal(size=(*SHAPE[:2], 1)) * np.ones(SHAPE)
    found = split(PARTS, near, truth + 0.06 * noise, np.full(SHAPE, 0.06))
    assert found.whole.is_noise
    assert not found.together.is_noise
    fractions = [found.fraction(share) for share in found.parts.values()]
    assert sum(fractions) == pytest.approx(1, abs=1e-12)


def test_what_cannot_be_told_from_noise_has_no_fractions() -> None:
    truth, _ = pictures()
    drawn = {one: truth * (1 + 1e-6 * len(one)) for one in coalitions(PARTS)}
    noise = np.random.default_rng(7).normal(size=SHAPE)
    found = split(PARTS, drawn, truth + 0.1 * noise, np.full(SHAPE, 0.1))
    assert found.together.is_noise
    assert np.isnan(found.fraction(found.parts["a"]))
