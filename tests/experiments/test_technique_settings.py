"""Whatever setting a technique has can be given in a suite and on the command line."""

from __future__ import annotations

import inspect

from experiments.render_cli import render
from experiments.suite import Suite, TechniqueChoice, cases_of
from experiments.technique_label import technique_label
from gpu_impl.techniques import CHOICES, RANGES, SETTINGS, find_technique


def test_every_setting_is_named_or_a_number() -> None:
    assert {"visibility", "airlight", *SETTINGS} == CHOICES.keys() | RANGES.keys()


def test_suites_take_every_setting() -> None:
    assert TechniqueChoice.model_fields.keys() == {"name", "visibility", "airlight", *SETTINGS}


def test_the_command_takes_every_setting() -> None:
    assert {"visibility", "airlight_model", *SETTINGS} <= inspect.signature(render).parameters.keys()


def case_names(*choices: dict) -> list[str]:
    suite = {"scenes": ["empty"], "size": [2, 2], "techniques": list(choices)}
    return [case.name for case in cases_of(Suite.model_validate({"products": [suite]}))]


def test_a_case_is_called_after_the_settings_that_are_not_its_techniques_own() -> None:
    changed = {"steps": 5, "shadow_map": 8, "upsample": "bilinear", "composition": "printed"}
    cell = {"name": "Weng2010", "airlight": "quadrature", "shadow_map": 8}
    assert case_names({"name": "Weng2010"} | changed, cell) == [
        "empty-Weng2010-steps-5-shadow_map-8-upsample-bilinear-composition-printed",
        "empty-lit_intervals+quadrature-shadow_map-8",
    ]


def test_names_of_files_have_no_colon() -> None:
    assert case_names({"name": "Weng2010:two-ei", "steps": 5}) == ["empty-Weng2010-two-ei-steps-5"]


def test_a_label_says_which_settings_are_not_the_techniques_own() -> None:
    own = find_technique("Weng2010")
    assert technique_label(own.name, vars(own)) == "Weng2010"
    changed = vars(find_technique("Weng2010", steps=5, upsample="bilinear"))
    assert technique_label("Weng2010", changed) == "Weng2010, steps 5, upsample bilinear"
    # the rows of a table hold text
    assert technique_label("Weng2010", {key: str(value) for key, value in changed.items()}).endswith("bilinear")
