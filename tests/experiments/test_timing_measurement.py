"""The measurements `timing` and `counts` on made-up clocks and on small real scenes."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import airlight
from experiments.measurements import find_measurement, timing
from experiments.measurements.counts import counts
from experiments.measurements.shot import Shot
from experiments.rounds import Times
from experiments.run.truth import Truth
from experiments.suite.cases import Case
from experiments.suite.schema import CameraChoice, ReferenceChoice
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from gpu_impl.timing import PASSES
from scenes.loader import load

SIZE = 24, 16
CASE = Case(
    name="made-up",
    product="",
    scene="half_plane",
    size=SIZE,
    parameters={},
    camera=CameraChoice(),
    triangles=None,
    technique=find_technique("lit_intervals+quadrature", steps=16, shadow_map=64),
    measure=("timing",),
    reference=ReferenceChoice(),
    pictures="none",
    rounds=6,
    baseline=find_technique("Nishita1987", steps=16, shadow_map=64),
    time_limit=60.0,
)


@pytest.fixture(scope="module")
def renderer() -> Iterator[Renderer]:
    with Renderer(load("half_plane", size=SIZE, phase="rayleigh")) as found:
        yield found


def shot_of(renderer: Renderer, **changes: object) -> Shot:
    return Shot(replace(CASE, **changes), renderer.scene, renderer, Truth())


def test_only_timings_need_a_quiet_machine() -> None:
    assert [find_measurement(name).needs_quiet for name in ("timing", "counts", "regions")] == [True, False, False]


def test_ratios_are_of_one_round(renderer: Renderer, monkeypatch) -> None:
    # the machine is four times slower in every other round; nine ratios are 1/2 and one is 1/5
    slow = np.array([1.0, 4.0] * 5)
    mine, baseline = 50 * slow, 100 * slow
    baseline[9] *= 2.5
    asked: dict[str, object] = {}

    def rounds(_: Renderer, techniques: dict[str, object], number: int) -> dict[str, Times]:
        asked.update(techniques=techniques, number=number)
        passes = {"surface": 10 * slow, "shadow map": slow}
        return {"technique": Times(mine, 1.5 * mine, passes), "baseline": Times(baseline, baseline, {})}

    monkeypatch.setattr(timing, "time_in_rounds", rounds)
    found = timing.timing(shot_of(renderer, rounds=10))
    assert asked == {"techniques": {"technique": CASE.technique, "baseline": CASE.baseline}, "number": 10}
    assert [found[f"timing.ratio_{part}"] for part in (25, 50, 75)] == [0.5, 0.5, 0.5]
    # the second smallest of ten and the second largest
    assert (found["timing.ratio_low"], found["timing.ratio_high"]) == (0.5, 0.5)
    assert (found["timing.ms_50"], found["timing.ms_25"], found["timing.ms_75"]) == (125.0, 50.0, 200.0)
    assert found["timing.baseline_ms_25"] == 100.0
    assert found["timing.clocked_ms"] == 1.5 * 125.0
    assert (found["timing.surface_ms"], found["timing.shadow_map_ms"]) == (25.0, 2.5)
    assert found["timing.shadow_polygons_ms"] == 0.0
    assert found["timing.no_interval"] is found["timing.baseline_refusal"] is None
    assert found["timing.baseline"] == "Nishita1987, steps 16, shadow_map 64"


def test_a_frame_is_timed_beside_its_baseline(renderer: Renderer) -> None:
    found = timing.timing(shot_of(renderer))
    for name in ("ms", "baseline_ms", "ratio"):
        assert 0 < found[f"timing.{name}_25"] <= found[f"timing.{name}_50"] <= found[f"timing.{name}_75"]
    assert found["timing.ratio_low"] <= found["timing.ratio_50"] <= found["timing.ratio_high"]
    # lit intervals are found between shadow polygons
    assert all(found[timing.pass_column(name)] > 0 for name in PASSES)
    assert found["timing.rounds"] == 6
    assert found["timing.clock"] in ("wall clock around glFinish", "GL_TIME_ELAPSED")
    assert found["timing.load"] >= 0


def test_a_baseline_that_refuses_says_why_there_is_no_ratio(renderer: Renderer) -> None:
    closed_form = find_technique("lit_intervals+weng2010", steps=16, shadow_map=64)
    found = timing.timing(shot_of(renderer, baseline=closed_form))
    assert found["timing.ms_50"] > 0
    assert "takes the phase function isotropic" in found["timing.baseline_refusal"]
    assert found["timing.no_interval"] == found["timing.baseline_refusal"]
    ratios = [value for name, value in found.items() if "ratio" in name or "baseline_ms" in name]
    assert ratios == [None] * 8


def test_few_rounds_give_a_ratio_without_an_interval(renderer: Renderer) -> None:
    found = timing.timing(shot_of(renderer, rounds=3))
    assert found["timing.ratio_50"] > 0
    assert found["timing.ratio_low"] is found["timing.ratio_high"] is None
    assert found["timing.no_interval"] == "3 rounds, and an interval takes 6"


def test_what_others_do_meanwhile_is_not_what_this_process_does(monkeypatch) -> None:
    now = SimpleNamespace(clock=10.0, machine=500.0, mine=100.0)
    monkeypatch.setattr(timing.time, "perf_counter", lambda: now.clock)
    monkeypatch.setattr(
        timing.psutil, "cpu_times", lambda: SimpleNamespace(user=now.machine, nice=7.0, system=3.0, idle=1e6)
    )
    monkeypatch.setattr(os, "times", lambda: SimpleNamespace(user=now.mine, system=1.0))
    others = timing.OtherProcesses()
    # in 4 s the machine worked 7 s, this process 5 of them
    now.clock, now.machine, now.mine = 14.0, 507.0, 105.0
    assert others.processors() == 0.5
    # clocks that tick apart make nobody busy by less than nothing
    now.mine = 107.5
    assert others.processors() == 0.0


def test_counts_of_a_scene_that_is_all_lit() -> None:
    with Renderer(load("empty", size=SIZE)) as renderer:
        march = find_technique("uniform_march+quadrature", steps=7, shadow_map=64)
        found = counts(shot_of(renderer, technique=march))
        # every step of every ray is lit, and asks the map once
        assert found["counts.pieces"] == found["counts.shadow_map_reads"] == 7
        assert found["counts.lit_intervals"] == found["counts.lit_intervals_max"] == 7
        assert found["counts.exponential_integrals"] == 0 < found["counts.exponentials"]
        assert found["counts.rays"] == 24 * 16
        assert found["counts.triangles"] == sum(len(mesh.faces) for mesh in renderer.scene.meshes)
        merged = counts(shot_of(renderer, technique=replace(CASE.technique, downsample=4)))
        assert (merged["counts.pieces"], merged["counts.rays"]) == (1, 6 * 4)


def test_lit_intervals_are_those_of_ray_casting() -> None:
    scene = load("eye_in_shadow", size=SIZE)
    with Renderer(scene) as renderer:
        found = counts(shot_of(renderer, technique=replace(CASE.technique, steps=256, shadow_map=1024)))
    # some rays see no light
    pieces = np.bincount(airlight.lit_intervals(scene).pixel, minlength=SIZE[0] * SIZE[1])
    assert found["counts.lit_intervals_max"] == pieces.max() == 1
    # measured: 340 of 384 in both
    assert found["counts.lit_intervals"] == pytest.approx(pieces.mean(), rel=1e-6)
    assert pieces.mean() < 0.9
