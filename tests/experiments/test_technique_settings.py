"""Whatever setting a technique has can be given in a suite and on the command line."""

from __future__ import annotations

import inspect

import airlight
from experiments.cli import render
from experiments.runner import case_name
from experiments.suite import TechniqueChoice
from gpu_impl.techniques import CHOICES, RANGES, SETTINGS


def test_every_setting_is_named_or_a_number() -> None:
    assert {"visibility", "airlight", *SETTINGS} == CHOICES.keys() | RANGES.keys()


def test_suites_take_every_setting() -> None:
    assert TechniqueChoice.model_fields.keys() == {"name", "visibility", "airlight", *SETTINGS}


def test_the_command_takes_every_setting() -> None:
    assert {"visibility", "airlight_model", *SETTINGS} <= inspect.signature(render).parameters.keys()


def test_a_case_is_called_after_the_settings_that_are_not_its_techniques_own() -> None:
    scene = airlight.load("empty", size=(2, 2))
    changed = {"steps": 5, "shadow_map": 8, "upsample": "bilinear", "composition": "printed"}
    frame = airlight.render(scene, "Weng2010", **changed)
    assert case_name(scene, frame) == "empty-Weng2010-steps-5-shadow_map-8-upsample-bilinear-composition-printed"
    cell = airlight.render(scene, "Weng2010", airlight="quadrature", shadow_map=8)
    assert case_name(scene, cell) == "empty-lit_intervals+quadrature-shadow_map-8"
