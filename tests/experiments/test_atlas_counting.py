"""What the counting arrays count, and that they compute the same bits."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import special

from analytic import MODELS
from analytic import exponential_integral as module
from analytic.models import AirlightModel, sun2005
from experiments.atlas.atlas import PHASES
from experiments.atlas.counting import OPERATIONS, count_operations
from experiments.atlas.errors import PRECISIONS, TRUTH
from experiments.atlas.grid import make_grid

ISOTROPIC = PHASES[0]
SEGMENTS = make_grid(4).segments


def counts(function, segments=SEGMENTS):
    """Operations that are not 0."""
    found = count_operations(AirlightModel("toy", function, "", "", ""), segments, ISOTROPIC)
    assert tuple(found) == OPERATIONS
    return {name: count for name, count in found.items() if count}


def test_functions_of_real_arrays():
    def function(s, phase):
        rows = np.exp(-s.h[:, None] * np.arange(3.0))  # three a segment
        total = rows.sum(axis=1) + np.sqrt(s.h) + np.hypot(s.h, s.x_a) + np.log1p(s.h)
        total += np.arctan2(s.h, s.x_a) + np.sin(s.h)
        total /= 1 + s.length
        return total * (1 / s.h)

    # np.exp of the constant alone would count nothing
    assert counts(function) == {
        "exponentials": 3,
        "square_roots": 2,
        "logarithms": 1,
        "trigonometric": 2,
        "divisions": 2,
    }


def test_plain_arrays_count_nothing():
    assert counts(lambda s, phase: s.h * np.exp(np.linspace(0, 1, 64)).sum()) == {}


def test_both_sides_of_where_but_masked_elements_alone():
    half = np.arange(len(SEGMENTS)) % 2 == 0

    def function(s, phase):
        both = np.where(s.x_a > 0, np.sqrt(s.h), np.exp(-s.h))
        result = np.zeros_like(s.h)
        result[half] = np.log(both[half])
        np.exp(result, out=result)
        return np.where(half, result, np.full_like(s.h, 1.0))

    assert counts(function) == {"square_roots": 1, "exponentials": 2, "logarithms": 0.5}


def test_powers():
    """Whole ones are products, x^(1/2) is a square root, any other an exponential and a logarithm."""
    assert counts(lambda s, phase: s.h**2 + s.h**3) == {}
    assert counts(lambda s, phase: s.h**0.5) == {"square_roots": 1}
    assert counts(lambda s, phase: s.h**1.5) == {"exponentials": 1, "logarithms": 1}


def test_complex_numbers():
    def function(s, phase):
        z = s.h + 1j * s.length
        return (np.exp(-z) + np.sqrt(z) + np.log(z)).imag + np.abs(z)

    assert counts(function) == {"exponentials": 1, "logarithms": 1, "square_roots": 4, "trigonometric": 3}


def test_exponential_integrals_count_as_one_whatever_they_do_inside():
    """scipy's, and ours where a model has imported them."""
    assert counts(lambda s, phase: special.expi(s.h)) == {"exponential_integrals": 1}
    merged = MODELS["weng2010"]
    found = count_operations(merged, SEGMENTS.astype(np.float32), ISOTROPIC)
    assert found["exponential_integrals"] == 2
    assert found["exponentials"] == 2
    assert found["logarithms"] == 0  # the series inside has one


def test_a_table_read_counts_once_and_so_does_what_it_computes():
    def function(s, phase):
        return np.exp(-s.h) * sun2005.read(table, s.optical_h, s.length)

    table = sun2005.Table(np.ones((4, 4)), 10.0, "root")
    assert counts(function) == {"table_reads": 1, "exponentials": 1, "square_roots": 1, "divisions": 2}


def test_wrapping_leaves_no_trace():
    from analytic.models.weng2010 import merged

    before = merged.scaled_e1
    count_operations(MODELS["weng2010"], SEGMENTS, ISOTROPIC)
    assert merged.scaled_e1 is before is module.scaled_e1
    with pytest.raises(ZeroDivisionError):
        counts(lambda s, phase: 1 // 0)
    assert merged.scaled_e1 is before


def test_what_cannot_be_counted_is_an_error():
    with pytest.raises(ValueError, match="toy cannot be counted"):
        counts(lambda s, phase: np.asarray(s.h))


def test_other_bits_than_uncounted_are_an_error():
    with pytest.raises(ValueError, match="toy cannot be counted"):
        counts(lambda s, phase: np.nextafter(s.h, np.inf) if type(s.h) is np.ndarray else s.h * 1)


@pytest.mark.parametrize(
    "widening",
    [
        lambda s: s.h * np.float64(2),
        lambda s: np.where(s.h > 1, s.h, np.linspace(0, 1, s.h.size)),
        lambda s: (s.h * np.complex128(1j)).imag,
    ],
)
def test_float64_on_the_way_is_an_error_in_float32(widening):
    def function(s, phase):
        return widening(s).astype(s.h.dtype)

    counts(function)
    with pytest.raises(ValueError, match="toy computes in float64 on the way"):
        counts(function, SEGMENTS.astype(np.float32))


def test_the_march_by_hand():
    """64 steps of e^-, sqrt and three divisions; the length is divided once; HG has a root and a division besides."""
    isotropic, hg = (count_operations(MODELS["riemann"], SEGMENTS, phase) for phase in (ISOTROPIC, PHASES[2]))
    assert isotropic == dict.fromkeys(OPERATIONS, 0) | {"exponentials": 64, "square_roots": 64, "divisions": 193}
    assert hg == isotropic | {"square_roots": 128, "divisions": 257}


@pytest.mark.parametrize("name", sorted(MODELS))
def test_every_model_can_be_counted(name):
    """In each precision and for each phase function: the bits are those of plain arrays, or this raises."""
    for phase in filter(MODELS[name].takes, PHASES):
        for precision in PRECISIONS:
            if (name, precision) != (TRUTH, "float32"):
                found = count_operations(MODELS[name], SEGMENTS.astype(precision), phase)
                assert found["exponentials"] + found["exponential_integrals"] + found["table_reads"] > 0
