"""Pieces of rays over the atlas's range, lit by an airlight model in GLSL and by its twin in analytic.

Rounding is measured in units of what rounding can do: |float32 - float64| beyond the bound that any shader is allowed,
over 2^-24 times the moduli of the form's terms times their optical depths. Both sides run the same form on the same
float32 pieces; they differ in the driver's exponentials, sines and fused products, in the order of a few operations,
and in that GLSL merges e^{sigma_t x_a} with the way before the piece. So neither is ahead on every piece, and the worst
of the two are compared.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from closed_form_moduli import rounding_unit

from analytic import MODELS
from analytic.phase import Phase
from analytic.segments import Segments
from experiments.atlas.grid import BESIDE, INSIDE, RANGE, VISIBLE_DEPTH
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.context import shared_context
from gpu_impl.device import Device
from gpu_impl.passes.scattering import TABLE_UNIT, phase_uniforms
from gpu_impl.shader_source import set_uniforms

CELLS, WIDTH, SEED = 16, 1024, 7
SIGMA_T = (0.13, 0.37, 0.9, 1.7, 4.1, 9.3)
# a grey medium that fills space, and a point light
DEFINES = {"GREY": 1, "DIRECTIONAL": 0, "WHOLE_LEG": 1, "FOG_PLANES": 0, "FOG_BALL": 0, "SPOT": 0, "SPOT_TEXTURE": 0}
MAIN = """layout(location = 0) out vec4 result;
#include "<airlight>"
uniform sampler2D pieces;
void main() {
    vec4 piece = texelFetch(pieces, ivec2(gl_FragCoord.xy), 0);   // h, t_h, t0, dt
    Ray ray = Ray(vec3(0.0), vec3(0.0, 0.0, 1.0), piece.z + piece.w);
    Light light = Light(vec3(piece.x, 0.0, piece.y), vec3(0.0, 0.0, 1.0), vec3(1.0), 3.15, 3.15);
    START_COUNTING;
    result = vec4(airlight(ray, light, piece.z, piece.w), 0.0);
#ifdef COUNTING
    result.a = counts.z;
#endif
}"""


@dataclass(frozen=True)
class Pieces:
    """Pieces of rays, float32, (n,); `way` is what e^{-sigma_t t0} of the light survives before each, float64."""

    segments: Segments
    t0: np.ndarray
    way: np.ndarray

    @property
    def visible(self) -> np.ndarray:
        return self.segments.sigma_t * self.segments.d_a <= VISIBLE_DEPTH


@cache
def pieces() -> Pieces:
    """The atlas's positions in fewer cells, every other piece some way from the eye."""
    random, axis = np.random.default_rng(SEED), np.geomspace(*RANGE, CELLS)
    positions = np.arange(2 * BESIDE.size + INSIDE.size)
    optical_h, length, k = (a.ravel() for a in np.meshgrid(axis, axis, positions, indexing="ij"))
    beside = np.concatenate([-BESIDE, BESIDE, np.zeros(INSIDE.size)])[k]
    inside = np.concatenate([np.zeros(2 * BESIDE.size), INSIDE])[k]
    sigma_t = np.array(SIGMA_T, np.float32)[random.integers(len(SIGMA_T), size=k.size)]
    x_a, h, length = ((a / sigma_t).astype(np.float32) for a in (beside - inside * length, optical_h, length))
    # t0 - t_h is x_a to the last digit, or t0 is 0: no error enters that the model does not make
    step = np.spacing(np.abs(x_a))
    t0 = np.round(random.integers(2, size=k.size) * random.uniform(0, 2, k.size) / sigma_t / step) * step
    t0 = np.where(np.float64(t0) - np.float64(x_a) == (t0 - x_a).astype(np.float32), t0, 0).astype(np.float32)
    return Pieces(Segments(h, x_a, x_a + length, length, sigma_t), t0, np.exp(-np.float64(sigma_t) * t0))


def shade(name: str, function: Phase, changed: dict[str, str] | None = None, **defines: int) -> np.ndarray:
    """The model's L / (I sigma_s) in GLSL, and the Ei it counted, (n, 2); `changed` holds texts of its files."""
    given, model, device = pieces(), AIRLIGHT_MODELS[name], Device(shared_context())
    program = device.program(
        "<main>",
        defines=DEFINES | defines,
        includes={"<airlight>": model.source, "<phase>": f"phase/{function.name}.glsl"},
        generated={"<main>": MAIN, **model.generated(function), **(changed or {})},
    )
    s = given.segments
    texels = np.stack([s.h, given.t0 - s.x_a, given.t0, s.length], axis=1)
    value = np.empty((len(s), 2))
    for sigma_t in np.unique(s.sigma_t):
        mine = np.flatnonzero(s.sigma_t == sigma_t)
        size = WIDTH, -(-mine.size // WIDTH)
        source, target, counts = (device.texture(size, 4) for _ in range(3))
        source.write(np.resize(texels[mine], (size[0] * size[1], 4)).tobytes())
        source.use(0)
        set_uniforms(program, {"pieces": 0, "sigma_t": (float(sigma_t),) * 3, "sigma_s": (1.0,) * 3})
        with phase_uniforms(device, program, function), table_uniforms(device, program, name, function):
            device.fill(program, target, counts)
        value[mine] = np.frombuffer(target.read(), np.float32).reshape(-1, 4)[: mine.size, ::3]
        for texture in (source, target, counts):
            texture.release()
    device.release()
    return value


@contextmanager
def table_uniforms(device: Device, program: Any, name: str, function: Phase) -> Iterator[None]:
    """Bind the model's table, where it has one."""
    make = AIRLIGHT_MODELS[name].table
    if make is None:
        yield
        return
    values = make(function)
    texture = device.context.texture(values.shape[::-1], 1, values.tobytes(), dtype="f4")
    texture.use(TABLE_UNIT)
    set_uniforms(program, {"airlight_table": TABLE_UNIT})
    yield
    texture.release()


@cache
def shader(name: str, function: Phase) -> np.ndarray:
    """The model as it is in GLSL, (n,)."""
    return shade(name, function)[:, 0]


def brightness(name: str, function: Phase) -> float:
    """Chapter 5's Rayleigh function is not normalised, which the twin of the print leaves out."""
    return 4 * np.pi if name == "weng2010:printed" and function.name == "rayleigh" else 1.0


@cache
def twin(name: str, function: Phase, precision: type) -> np.ndarray:
    """The same by analytic in float32 or float64, (n,), float64."""
    given = pieces()
    with np.errstate(all="ignore"):
        value = MODELS[name].function(given.segments.astype(precision), function).astype(np.float64)
    return brightness(name, function) * value * given.way


def worst_rounding(name: str, function: Phase, *values: np.ndarray) -> list[float]:
    """Of each of the values, (n,), over the visible pieces where all of them are finite, in its natural unit."""
    given, form = pieces(), twin(name, function, np.float64)
    s = given.segments.astype(np.float64)
    allowed = 2e-6 + 4 * 2**-24 * (1 + s.sigma_t * (given.t0 + s.d_a))
    unit = brightness(name, function) * rounding_unit(name, function, s, given.t0) * given.way
    with np.errstate(all="ignore"):
        errors = [(np.abs(value - form) - allowed * np.abs(form)) / unit for value in values]
    finite = np.isfinite(sum(errors)) & given.visible
    # measured: the print overflows, in the twin too, on a tenth of the pieces; the others nowhere
    assert finite.sum() > (0.85 if name == "weng2010:printed" else 0.999) * given.visible.sum()
    return [float(error[finite].max()) for error in errors]
