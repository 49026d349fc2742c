"""`--set KEY=VALUE` holds for the whole suite, or says why it cannot."""

from __future__ import annotations

import pytest

from experiments.suite import cases_of, load_suite
from scenes.errors import InputError

SMALL = 'scenes = ["empty"]\nsize = [4, 5]\n[[techniques]]\nname = "Weng2010"\nsteps = 7\n'
# two products with tables of their own, and one that takes those at the top
SEVERAL = """
scenes = ["empty"]
size = [4, 4]
parameters = { sigma_t = 0.5 }
settings = { downsample = 2 }
techniques = [{ name = "Weng2010" }]

[[products]]
name = "own"
settings = { steps = 64 }
parameters = { radius = 3.0 }

[[products]]
name = "others"
techniques = [{ name = "FrontFinal" }, { name = "Nishita1987", steps = 9 }]

[[products]]
name = "none"
"""


def test_set_reaches_whatever_a_file_can_hold(suite) -> None:
    changes = ("scenes=sphere", "techniques.0.steps=[8, 9]", "reference.rel_error=0.1", "parameters.sigma_t=0.3")
    cases = cases_of(suite(SMALL, *changes))
    assert [(case.scene, case.technique.steps) for case in cases] == [("sphere", 8), ("sphere", 9)]
    assert cases[0].reference.rel_error == 0.1
    assert cases[0].parameters == {"sigma_t": 0.3}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("size", "should be KEY=VALUE"),
        ("=3", "should be KEY=VALUE"),
        ("size=3", "the key 'size', as --set has it"),
        ("techniques.0.steps=many", "the key 'techniques.0.steps', as --set has it"),
        ("techniques.5.steps=3", "the suite has nothing at 'techniques.5.steps'"),
        ("scenes.name=3", "the suite has nothing at 'scenes.name'"),
        ("techniques.².steps=3", "the suite has nothing at 'techniques.².steps'"),
        # a digit nought, of another script
        ("techniques.\N{ARABIC-INDIC DIGIT ZERO}.steps=3", "the suite has nothing at 'techniques."),
        (f"techniques.{'1' * 5000}.steps=3", "the suite has nothing at 'techniques.111"),
        (f"size=[{'9' * 5000},4]", "the key 'size', as --set has it"),
        ("scenes=", "the key 'scenes', as --set has it: '' is neither a scene's name"),
        ("colour=1", "the key 'colour', as --set has it"),
    ],
)
def test_what_is_wrong_with_set_is_named(change: str, words: str, suite) -> None:
    with pytest.raises(InputError) as caught:
        suite(SMALL, change)
    assert words in str(caught.value)
    assert len(str(caught.value)) < 1500


def test_a_key_in_a_table_holds_for_products_that_have_that_table_themselves(suite) -> None:
    for case in cases_of(load_suite("aliasing", ["settings.steps=4"])[1]):
        assert case.technique.steps == 4
    cases = cases_of(suite(SEVERAL, "parameters.sigma_t=0.25", "techniques.0.steps=5", "settings.downsample=8"))
    found = {(case.product, case.technique.name, case.technique.steps, case.technique.downsample) for case in cases}
    assert found == {
        ("own", "Weng2010", 5, 8),
        ("others", "FrontFinal", 5, 8),
        ("others", "Nishita1987", 9, 8),
        ("none", "Weng2010", 5, 8),
    }
    assert [case.parameters for case in cases if case.product == "own"] == [{"radius": 3.0, "sigma_t": 0.25}]
    assert {case.parameters["sigma_t"] for case in cases} == {0.25}


def test_a_key_of_one_product_is_for_that_one(suite) -> None:
    changes = ("products.2.settings.steps=3", "products.0.settings.steps=4", "products.2.techniques.0.shadow_map=99")
    cases = cases_of(suite(SEVERAL, *changes))
    technique = {case.product: case.technique for case in cases if case.technique.name == "Weng2010"}
    # the rest of what stands at the top still holds for it
    assert (technique["none"].steps, technique["none"].downsample, technique["none"].shadow_map) == (3, 2, 99)
    assert (technique["own"].steps, technique["own"].shadow_map) == (4, technique["own"].shadow_map)
    assert technique["own"].shadow_map != 99
    assert {case.technique.downsample for case in cases if case.product == "others"} == {2}


def test_a_technique_that_only_products_have_is_reached() -> None:
    cases = cases_of(load_suite("paper", ["techniques.0.steps=5"])[1])
    assert {case.technique.steps for case in cases if case.technique.name == "Weng2010"} == {5}
    assert {case.technique.steps for case in cases if case.technique.name == "FrontFinal"} == {64}


def test_a_table_at_the_top_that_no_product_takes_need_not_have_the_key(suite) -> None:
    (case,) = cases_of(suite(SMALL + "[[products]]\ntechniques = [{ name = 'Weng2010' }]\n", "techniques.0.steps=5"))
    assert case.technique.steps == 5
    several = "[[products]]\ntechniques = [{ name = 'FrontFinal' }, { name = 'Weng2010' }]\n"
    assert [case.technique.steps for case in cases_of(suite(SMALL + several, "techniques.1.steps=5"))][1:] == [5]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("techniques.1.steps=3", "--set techniques.1.steps=3: the suite has nothing at 'techniques.1.steps'"),
        ("products.7.rounds=3", "the suite has nothing at 'products.7.rounds'"),
        ("products.².settings.steps=3", "the suite has nothing at 'products.²"),
        ("settings.steps=0", "the key 'products.0.settings.steps', as --set has it: steps is 0"),
        ("products.1.settings.steps=0", "the key 'products.1.settings.steps', as --set has it"),
        ("name.x=3", "the product 'own' has nothing at 'name.x'"),
    ],
)
def test_what_a_product_cannot_take_is_said_with_the_product(change: str, words: str, suite) -> None:
    with pytest.raises(InputError) as caught:
        cases_of(suite(SEVERAL, change))
    assert words in str(caught.value)


def test_a_product_without_so_many_techniques_is_named() -> None:
    with pytest.raises(
        InputError, match=r"^--set techniques.5.steps=3: the product 'steps' has nothing at 'techniques.5"
    ):
        load_suite("aliasing", ["techniques.5.steps=3"])
