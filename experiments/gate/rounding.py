"""Cases drawn with more than the rounding of another CPU or driver, to see what it can do to their values.

DESIGN: llvmpipe is not bit-identical between makers of CPUs, whose approximate reciprocals differ. No other maker is at
hand here, so eye and lights are moved by MOVED of their distance from the origin, which is 80 times float32's spacing,
the shaders' exp is off by as much again as llvmpipe's is, and their roots by two units in the last place. At a tenth of
MOVED the values of most cases move ten times less.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from experiments.gate.changed_shaders import changed_shaders
from experiments.gate.measuring import Values, measure_cases
from experiments.suite import Case
from scenes.model import Scene

MOVED = 1e-5
# relative errors: exp at optical depths up to 50, as measured on llvmpipe, and 2 ulp of float32 for roots
FUNCTIONS = {"exp": 3.5e-6, "sqrt": 2.4e-7, "inversesqrt": 2.4e-7}
# with functions too large, and as many with functions too small
TRIALS = 8


def perturbed_values(cases: Sequence[Case], tell: Callable[[str], None] = lambda text: None) -> Iterator[Values]:
    """Values of all cases in 2 x TRIALS trials."""
    random = np.random.default_rng(0)
    for sign in (1, -1):
        header = "".join(f"#define {name}(x) ({name}(x) * {1 + sign * off:.9f})\n" for name, off in FUNCTIONS.items())
        with changed_shaders(header=header):
            for number in range(TRIALS):
                tell(f"perturbed, {number + 1 + (TRIALS if sign < 0 else 0)} of {2 * TRIALS}")
                yield measure_cases(cases, lambda scene: moved(scene, random))


def moved(scene: Scene, random: np.random.Generator) -> Scene:
    """The scene with eye and lights moved in random directions; its name and digest stay."""

    def aside(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
        direction = random.normal(size=3)
        place = matrix.copy()
        place[:3, 3] += MOVED * np.linalg.norm(place[:3, 3]) * direction / np.linalg.norm(direction)
        return place

    camera = replace(scene.camera, to_world=aside(scene.camera.to_world))
    lights = []
    for light in scene.lights:
        to_world = aside(light.to_world)
        shift = to_world[:3, 3] - light.to_world[:3, 3]
        lights.append(replace(light, to_world=to_world, position=light.position + shift))
    return replace(scene, camera=camera, lights=tuple(lights))
