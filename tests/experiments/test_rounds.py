"""The rounds in which frames are timed: order, warm-up, and what is kept apart."""

from __future__ import annotations

import numpy as np

from experiments import rounds


class Silent:
    """A renderer that keeps who was drawn when, and takes 100 ms a frame number and 1 ms a letter of the name."""

    device = None

    def __init__(self) -> None:
        self.order: list[tuple[str, int, bool]] = []

    def frame_time(self, technique: object, number: int, clock: object = None) -> float:
        self.order.append((str(technique), number, clock is not None))
        return 100.0 * number + len(str(technique))


class Clock:
    def __init__(self, *_: object) -> None: ...
    def milliseconds(self) -> dict[str, float]:
        return {"surface": 2.0}


def test_rounds_run_each_once_in_an_order_of_their_own(monkeypatch) -> None:
    monkeypatch.setattr(rounds, "PassClock", Clock)
    renderer, names = Silent(), {name: name for name in ("a", "bb", "ccc", "dddd")}
    found = rounds.time_in_rounds(renderer, names, 8)
    of_round = [renderer.order[8 * n : 8 * n + 8] for n in range(9)]
    for number, one in enumerate(of_round):
        assert {frame for _, frame, _ in one} == {number}
        # without a clock, then with one, and in every other round the other way round
        assert {clocked for _, _, clocked in one[::2]} == {number % 2 == 1}
        assert [name for name, _, clocked in one if clocked] == [name for name, _, clocked in one if not clocked]
        assert sorted(name for name, _, clocked in one if clocked) == sorted(names)
    assert len({tuple(name for name, _, _ in one) for one in of_round}) > 5
    # the first round is not among them
    np.testing.assert_array_equal(found["bb"].milliseconds, 100.0 * np.arange(1, 9) + 2)
    np.testing.assert_array_equal(found["bb"].passes["surface"], np.full(8, 2.0))
    assert (found["bb"].pass_median("surface"), found["bb"].pass_median("shadow polygons")) == (2.0, 0.0)
