"""The shader's exponential integral against its twin in NumPy and against float64."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.exponential_integral import scaled_e1
from analytic.models.one_ei.orders import scaled_orders
from gpu_impl.context import shared_context
from gpu_impl.device import Device

MAIN = """out vec2 result;
#include "airlight/exponential_integral.glsl"
uniform sampler2D points;
void main() {{ result = {function}(texelFetch(points, ivec2(gl_FragCoord.xy), 0).xy){part}; }}"""
WIDTH = 1024


def shader(z: np.ndarray, function: str = "scaled_e1", part: str = "") -> np.ndarray:
    """F(z) by the GLSL, complex64 in and out, (n,)."""
    device = Device(shared_context())
    size = (WIDTH, -(-z.size // WIDTH))
    points, result = device.texture(size, 2), device.texture(size, 2)
    points.write(np.resize(z, size[0] * size[1]).tobytes())
    text = MAIN.format(function=function, part=part)
    program = device.program("<main>", includes={}, generated={"<main>": text})
    points.use(0)
    program["points"] = 0
    device.fill(program, result)
    value = np.frombuffer(result.read(), np.complex64)[: z.size]
    points.release()
    result.release()
    device.release()
    return value


def spread(low: float, high: float, count: int = 100_000) -> np.ndarray:
    """Points of the first quadrant, half of them close to an axis, complex64."""
    random = np.random.default_rng(3)
    modulus = np.exp(random.uniform(np.log(low), np.log(high), count))
    near_axis = np.arctan(10 ** random.uniform(-8, 8, modulus.size))
    angle = np.where(random.random(modulus.size) < 0.5, near_axis, random.uniform(0, np.pi / 2, modulus.size))
    z = (modulus * np.exp(1j * angle)).astype(np.complex64)
    return z[(z.real > 0) & (z.imag > 0)]


@pytest.mark.parametrize(
    ("low", "high", "both_allowed", "imaginary_allowed"),
    # measured over 7.7e5 points each on llvmpipe: 3.1e-7 / 7.7e-7, 5.6e-7 / 1.6e-6, 3.6e-7 / 4.2e-7; GLSL leaves a
    # logarithm 3 ulp, so that another driver may be off by as much again
    [(1e-6, 0.6, 6e-7, 1.5e-6), (0.6, 1.0, 9e-7, 2.6e-6), (1.0, 1e6, 6e-7, 8e-7)],
)
def test_the_first_quadrant(low, high, both_allowed, imaginary_allowed):
    z = spread(low, high)
    value, exact = shader(z).astype(complex), scaled_e1(z.astype(complex))
    assert np.max(np.abs(value / exact - 1)) < both_allowed
    assert np.max(np.abs(value.imag / exact.imag - 1)) < imaginary_allowed
    # the twin runs the same operations: what differs is the driver's logarithm and how it fuses; measured 7.1e-7
    assert np.max(np.abs(value / scaled_e1(z) - 1)) < 1.3e-6


@pytest.mark.parametrize(
    ("low", "high", "allowed"),
    # measured over 1e5 points on llvmpipe: 4.3e-7, 8.4e-7, 2.3e-6 and 2.1e-7; up to 24 its exponential, sine and cosine
    # enter, and near the cut grow with |z|
    [(1e-6, 1.0, 9e-7), (1.0, 6.0, 1.8e-6), (6.0, 24.0, 5e-6), (24.0, 1e6, 6e-7)],
)
def test_the_second_quadrant(low: float, high: float, allowed: float) -> None:
    z = -spread(low, high).conj()
    value, exact = shader(z, "scaled_e1_left").astype(complex), scaled_e1(z.astype(complex))
    assert np.max(np.abs(value / exact - 1)) < allowed


@pytest.mark.parametrize(
    ("order", "both_allowed", "imaginary_allowed"),
    # measured over 1e5 points on llvmpipe: 3.9e-7 / 8.9e-7, 7.1e-7 / 2.5e-6, 8.4e-7 / 3.1e-6
    [("first", 9e-7, 2e-6), ("second", 1.5e-6, 6e-6), ("third", 1.8e-6, 7e-6)],
)
def test_the_orders(order: str, both_allowed: float, imaginary_allowed: float) -> None:
    z = spread(1e-4, 1e6)
    value = shader(z, "scaled_orders", f".{order}").astype(complex)
    exact = scaled_orders(z.astype(complex))[("first", "second", "third").index(order)]
    assert np.max(np.abs(value / exact - 1)) < both_allowed
    assert np.max(np.abs(value.imag / exact.imag - 1)) < imaginary_allowed
