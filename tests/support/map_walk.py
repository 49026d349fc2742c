"""The visibility `exact` on rays and maps of one's own: the shader alone, and the intervals that it reports."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from gpu_impl.context import shared_context
from gpu_impl.device import Device
from gpu_impl.light_uniforms import placed
from gpu_impl.passes.shadow_buffer import in_buffer
from gpu_impl.passes.shadow_map import ShadowMap, render_shadow_map
from gpu_impl.shader_source import set_uniforms
from gpu_impl.timing import NO_CLOCK
from gpu_impl.visibilities.exact import ShadowPyramid
from gpu_impl.visibilities.strategy import Kept
from scenes.model import Light

# one of its corners decides how large a directional light's map is
BOUNDS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
IDENTITY = np.eye(4)
ROW = 64
FILE = "visibility/exact.glsl"
MAIN = """layout(std430, binding = 0) buffer Count { uint count; };
layout(std430, binding = 1) writeonly buffer Reported { vec4 reported[]; };
layout(location = 0) out vec4 result;
#include "<visibility>"
uniform Light light;
uniform sampler2D origins;      // and where the rays end
uniform sampler2D directions;

void lit(float t0, float dt, float w) {
    uint place = atomicAdd(count, 1u);
    if (place < uint(reported.length()))
        reported[place] = vec4(floor(gl_FragCoord.y) * 64.0 + floor(gl_FragCoord.x), t0, dt, w);
}

void main() {
    vec4 origin = texelFetch(origins, ivec2(gl_FragCoord.xy), 0);
    current_ray = Ray(origin.xyz, texelFetch(directions, ivec2(gl_FragCoord.xy), 0).xyz, origin.w);
    current_start = 0.0;
    result = vec4(0.0);
    START_COUNTING;
    visibility(current_ray, light);
}"""


@dataclass(frozen=True, eq=False)
class Walk:
    """Rays, a light and its map.

    Attributes
    ----------
    origin, direction : (n, 3) float32    directions of unit length but for rounding
    end : (n,) float32
    light : Light
    stored : (size, tiles * size) float32
    """

    origin: np.ndarray
    direction: np.ndarray
    end: np.ndarray
    light: Light
    stored: np.ndarray

    def map_of(self, device: Device) -> ShadowMap:
        """The map on the GPU: the matrices of the renderer's own, and the walk's distances."""
        size = len(self.stored)
        empty = SimpleNamespace(bounds=BOUNDS, meshes=[])
        drawn = render_shadow_map(device, empty, self.light, size)
        drawn.texture.write(np.ascontiguousarray(self.stored).tobytes())
        return drawn


def point_light() -> Light:
    return Light("point", np.array([0.1, -0.2, 0.3]), np.ones(3), IDENTITY, np.pi, np.pi)


def spot_light(half_angle: float = 0.6) -> Light:
    # along (0.6, 0, 0.8), off the axes
    frame = np.eye(4)
    frame[:3, :3] = np.array([[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]])
    return Light("spot", np.array([0.1, -0.2, -0.5]), np.ones(3), frame, half_angle, half_angle)


def sun() -> Light:
    return placed(replace(spot_light(), kind="directional"), BOUNDS)


def reported(walk: Walk, storage: str = "texture", changed: dict[str, str] | None = None) -> tuple[list, np.ndarray]:
    """What the shader reports: per ray (begin, length) sorted, and the map's reads, (n,).

    Parameters
    ----------
    changed : texts in place of files
    """
    device = Device(shared_context())
    shadow_map, kept = walk.map_of(device), Kept()
    if storage == "buffer":
        shadow_map = in_buffer(device, shadow_map)
    supply = ShadowPyramid(SimpleNamespace(shadow_map=shadow_map, device=device, kept=kept, clock=NO_CLOCK))
    spot, parallel = walk.light.kind == "spot", walk.light.kind == "directional"
    defines = {"GREY": 1, "DIRECTIONAL": int(parallel), "WHOLE_LEG": 0, "FOG_PLANES": 0, "FOG_BALL": 0}
    defines |= {"SPOT": int(spot), "SPOT_TEXTURE": 0, "SHADOW_GIVEN": 0, "COUNTING": 1, **shadow_map.defines}
    program = device.program(
        "<main>",
        defines=defines | dict(supply.defines),
        includes={"<visibility>": FILE, "<lattice>": "lattice/grid.glsl"},
        generated={"<main>": MAIN, **(changed or {})},
    )
    n = len(walk.end)
    size = ROW, -(-n // ROW)

    def texture(values: np.ndarray) -> Any:
        filled = np.resize(values.astype(np.float32), (size[0] * size[1], 4))
        one = device.texture(size, 4)
        one.write(filled.tobytes())
        return one

    rays = [np.column_stack([part, walk.end]) for part in (walk.origin, walk.direction)]
    # no surface ends them
    textures = [texture(part) for part in (*rays, np.zeros((n, 4)))]
    for unit, one in enumerate(textures, start=1):
        one.use(unit)
    light = walk.light
    uniforms = {"origins": 1, "directions": 2, "normal_and_distance": 3, "light.position": tuple(light.position)}
    uniforms |= {"light.direction": tuple(light.direction), "light.cutoff_angle": light.cutoff_angle}
    set_uniforms(program, uniforms | {"downsample": 1} | shadow_map.bind(0))
    supply.bind(program)
    count, pieces = device.context.buffer(bytes(4)), device.context.buffer(reserve=16 * 4000 * n)
    count.bind_to_storage_buffer(0)
    pieces.bind_to_storage_buffer(1)
    target, counts = device.texture(size, 4), device.texture(size, 4)
    device.fill(program, target, counts)
    device.context.memory_barrier()
    (total,) = np.frombuffer(count.read(), np.uint32)
    found = np.frombuffer(pieces.read(16 * int(total)), np.float32).reshape(-1, 4).astype(np.float64)
    reads = np.frombuffer(counts.read(), np.float32).reshape(-1, 4)[:n, 1]
    for one in (*textures, target, counts, count, pieces, shadow_map.memory):
        one.release()
    kept.release()
    device.release()
    assert (found[:, 3] == 1).all()
    told = [found[found[:, 0] == ray] for ray in range(n)]
    return [pieces[np.argsort(pieces[:, 1])][:, 1:3] for pieces in told], reads


def apart(intervals: np.ndarray, expected: list[tuple[float, float]]) -> float:
    """Length of what lies in one set of intervals and not in the other; a stretch that is told twice counts too.

    Parameters
    ----------
    intervals : (n, 2)    begin and length
    expected : (begin, end) each
    """
    events = [(begin, 1) for begin, _ in intervals] + [(begin + length, -1) for begin, length in intervals]
    events += [(begin, -1) for begin, _ in expected] + [(end, 1) for _, end in expected]
    events.sort()
    level, total = 0, 0.0
    for (t, step), (following, _) in itertools.pairwise(events):
        level += step
        total += abs(level) * (following - t)
    return total
