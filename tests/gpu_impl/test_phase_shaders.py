"""The phase functions in GLSL have the values of float64, at forward peaks too."""

from __future__ import annotations

import numpy as np
import pytest

from analytic import phase
from gpu_impl.context import shared_context
from gpu_impl.device import Device
from gpu_impl.passes.scattering import phase_uniforms

CASES = [
    {"name": "isotropic"},
    {"name": "rayleigh"},
    *({"name": "hg", "g": g} for g in (-0.9, 0.6, 0.9)),
    *({"name": "schlick", "k": k} for k in (-0.9, 0.0, 0.6, 0.95)),
    *({"name": "cornette_shanks", "g": g} for g in (-0.9, 0.0, 0.9)),
    {"name": "tabulated", "values": (1.0, 3.0)},
    {"name": "tabulated", "values": (0.5, 1.0, 1.5, 2.0, 5.0)},
    {"name": "tabulated", "values": tuple(phase("hg", g=0.9).evaluate(np.linspace(-1, 1, 181)))},
]
WIDTH = 2048
# pixels are spaced evenly in ln tan(theta / 2) from e^-9 to e^9
MAIN = f"""out vec4 result;
#include "<phase>"
void main() {{
    float v = exp((gl_FragCoord.x / {WIDTH}.0 - 0.5) * 18.0), cos2 = 1.0 / (1.0 + v * v);
    vec2 half_angle = vec2(cos2, v * v * cos2);
    result = vec4(half_angle, phase(half_angle), phase_scale());
}}"""


@pytest.mark.parametrize("case", CASES, ids=lambda case: " ".join(str(value)[:20] for value in case.values()))
def test_values(case: dict) -> None:
    function, device = phase(**case), Device(shared_context())
    texture = device.texture((WIDTH, 1), 4)
    includes = {"<phase>": f"phase/{function.name}.glsl"}
    program = device.program("<main>", includes=includes, generated={"<main>": MAIN})
    with phase_uniforms(device, program, function):
        device.fill(program, texture)
        cos2, sin2, value, scale = np.frombuffer(texture.read(), np.float32).reshape(WIDTH, 4).T.astype(np.float64)
    # the cosine as float64 has it, from the half angles that the shader was given
    exact = function.evaluate(np.where(sin2 < cos2, 1 - 2 * sin2, 2 * cos2 - 1))
    # measured 7e-7 at worst (llvmpipe)
    assert np.max(np.abs(value / exact - 1)) < 3e-6
    assert 0 < scale[0] <= 10
    texture.release()
    device.release()
