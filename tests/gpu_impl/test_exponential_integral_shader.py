"""The shader's exponential integral against its twin in NumPy and against float64."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.exponential_integral import scaled_e1
from gpu_impl.context import shared_context
from gpu_impl.device import Device

MAIN = """out vec2 result;
#include "airlight/exponential_integral.glsl"
uniform sampler2D points;
void main() { result = scaled_e1(texelFetch(points, ivec2(gl_FragCoord.xy), 0).xy); }"""
WIDTH = 1024


def shader(z: np.ndarray) -> np.ndarray:
    """F(z) by the GLSL, complex64 in and out, (n,)."""
    device = Device(shared_context())
    size = (WIDTH, -(-z.size // WIDTH))
    points, result = device.texture(size, 2), device.texture(size, 2)
    points.write(np.resize(z, size[0] * size[1]).tobytes())
    program = device.program("<main>", includes={}, generated={"<main>": MAIN})
    points.use(0)
    program["points"] = 0
    device.fill(program, result)
    value = np.frombuffer(result.read(), np.complex64)[: z.size]
    points.release()
    result.release()
    device.release()
    return value


@pytest.mark.parametrize(
    ("low", "high", "both_allowed", "imaginary_allowed"),
    # measured over 1e6 points on llvmpipe: 2.7e-7 / 7.2e-7, 4.5e-7 / 1.3e-6, 3.2e-7 / 4.0e-7; GLSL leaves a logarithm
    # 3 ulp, so that another driver may be off by as much again
    [(1e-6, 0.6, 6e-7, 1.5e-6), (0.6, 1.0, 9e-7, 2.6e-6), (1.0, 1e6, 6e-7, 8e-7)],
)
def test_the_first_quadrant(low, high, both_allowed, imaginary_allowed):
    random = np.random.default_rng(3)
    modulus = np.exp(random.uniform(np.log(low), np.log(high), 100_000))
    near_axis = np.arctan(10 ** random.uniform(-8, 8, modulus.size))
    angle = np.where(random.random(modulus.size) < 0.5, near_axis, random.uniform(0, np.pi / 2, modulus.size))
    z = (modulus * np.exp(1j * angle)).astype(np.complex64)
    z = z[(z.real >= 0) & (z.imag > 0)]
    value, exact = shader(z).astype(complex), scaled_e1(z.astype(complex))
    assert np.max(np.abs(value / exact - 1)) < both_allowed
    assert np.max(np.abs(value.imag / exact.imag - 1)) < imaginary_allowed
    # the twin runs the same operations: what differs is the driver's logarithm and how it fuses; measured 6.5e-7
    assert np.max(np.abs(value / scaled_e1(z) - 1)) < 1.3e-6
