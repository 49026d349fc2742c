"""Shaders that are spoilt on purpose trip the gate, leave nothing behind, and edits that miss are errors."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from experiments.gate.changed_shaders import Edit, changed_shaders
from experiments.gate.limits import Limits, limits_for
from experiments.gate.measuring import Values, measure_cases
from experiments.gate.mutations import MUTATIONS, Mutation, try_mutation
from experiments.gate.suite import gate_cases, stand_in_meshes
from experiments.gate.verdicts import judge
from gpu_impl import shader_source
from gpu_impl.shader_source import SHADERS, ShaderError
from scenes.errors import InputError

BY_NAME = {mutation.name: mutation for mutation in MUTATIONS}
# of some mutations a case that must notice and one that must not
SEEN_BY = {
    "flipped g": ("whole-sphere-hg-0.6-Nishita1987", "whole-sphere-rayleigh-Nishita1987"),
    "half-step shift": (
        "closed-eye_in_shadow-rayleigh-Weng2010",
        "whole-sphere-rayleigh-Nishita1987",
    ),
    "bilinear for bilateral": (
        "lattice-sphere-lit_intervals+quadrature-downsample-2",
        "lattice-sphere-lit_intervals+quadrature-downsample-2-upsample-nearest_depth",
    ),
    "grey samples": ("coloured-coloured-Nishita1987", "whole-sphere-rayleigh-Nishita1987"),
    "grey models": ("coloured-coloured-lit_intervals+quadrature", "whole-sphere-rayleigh-Nishita1987"),
    "red for blue": ("coloured-coloured-Nishita1987", "coloured-coloured-lit_intervals+quadrature"),
    "half a sun": ("coloured-coloured-Nishita1987", "whole-sphere-rayleigh-Nishita1987"),
    "unweighted cut": ("coloured-coloured-uniform_march-jittered+riemann", "coloured-coloured-Nishita1987"),
}
NAMES = sorted({name for names in SEEN_BY.values() for name in names})


@pytest.fixture(autouse=True)
def _stand_ins() -> Iterator[None]:
    with stand_in_meshes():
        yield


@pytest.fixture(scope="module")
def limits() -> Limits:
    return limits_for(gate_cases())


@pytest.fixture(scope="module")
def control() -> Values:
    return measure_cases(gate_cases(NAMES))


def test_the_control_passes(control: Values, limits: Limits) -> None:
    assert [str(verdict) for verdict in judge(control, limits) if not verdict.passes] == []


@pytest.mark.parametrize("name", SEEN_BY)
def test_a_mutation_is_noticed_where_it_matters_and_nowhere_else(name: str, limits: Limits, control: Values) -> None:
    cases = gate_cases(SEEN_BY[name])
    outcome = try_mutation(BY_NAME[name], cases, limits)
    assert {verdict.case for verdict in outcome.failed} == {SEEN_BY[name][0]}
    assert outcome.failed[0].badness > 10
    # the other case is drawn as it was, bit for bit, and afterwards both are
    again = measure_cases(cases)
    assert again == {case.name: control[case.name] for case in cases}


def test_a_picture_that_is_not_finite_is_noticed(limits: Limits) -> None:
    mutation = Mutation("no number", "", (Edit("airlight/riemann.glsl", "return light", "return 1e38 * 1e38 * light"),))
    outcome = try_mutation(mutation, gate_cases(NAMES[-1:]), limits)
    assert outcome.noticed
    assert "is no number" in str(outcome.failed[0])


def test_every_edit_finds_its_text() -> None:
    for mutation in MUTATIONS:
        for edit in mutation.edits:
            text = (SHADERS / edit.file).read_text(encoding="utf-8")
            assert edit.applied(text) != text
    assert {mutation.name for mutation in MUTATIONS if mutation.must} >= set(SEEN_BY)
    assert len(BY_NAME) == len(MUTATIONS)


@pytest.mark.parametrize(
    ("edit", "sentence"),
    [
        (Edit("light.glsl", "no such text", ""), "stands 0 times in gpu_impl/shaders/light.glsl"),
        (Edit("light.glsl", "light.position", ""), r"stands \d+ times in gpu_impl/shaders/light.glsl"),
        (Edit("no_such.glsl", "", ""), "There is no shader no_such.glsl"),
    ],
)
def test_an_edit_that_misses_is_an_error(edit: Edit, sentence: str) -> None:
    before = shader_source.SHADERS, shader_source.HEADER
    with pytest.raises(InputError, match=sentence), changed_shaders((edit,), "// header\n"):
        pass
    assert before == (shader_source.SHADERS, shader_source.HEADER)


def test_a_mutation_that_does_not_compile_is_an_error(limits: Limits) -> None:
    mutation = Mutation("typo", "", (Edit("airlight/riemann.glsl", "float d2 = max(", "float d2 = maximum("),))
    before = shader_source.SHADERS
    with pytest.raises(ShaderError, match="maximum"):
        try_mutation(mutation, gate_cases(NAMES[-1:]), limits)
    assert before == shader_source.SHADERS
