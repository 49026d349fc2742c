"""How many samples a march of the whole ray takes to be as dense as one of the shadow region."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gpu_impl.airlight_models import AIRLIGHT_MODELS, AirlightShader
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import RANGES, Technique
from gpu_impl.visibilities import VISIBILITIES, Visibility

# a model that returns the length of a lit piece, and a strategy that knows no shadows
LENGTH, WHOLE = "length of lit pieces", "no shadows"
TEXTS = {
    "<length>": "const bool CLIP_TO_CONE = true;\n"
    "vec3 airlight(Ray ray, Light light, float t0, float dt) { return vec3(dt); }\n",
    "<whole>": "uniform sampler2D shadow_map;\nvoid visibility(Ray ray, Light light) { lit(0.0, ray.t_max, 1.0); }\n",
}


def steps_as_dense(renderer: Renderer, bounded: Technique) -> int:
    """Samples with which the whole ray in the light's cone is sampled as densely as `bounded` samples its region.

    On average over the rays that have a shadow region: their length in the cone over that of their regions, times the
    samples that `bounded` takes; the regions are those between the first and the last shadow polygon.
    """
    with _measures_of_length():
        whole, outside = (
            _lengths(renderer, replace(bounded, visibility=visibility, airlight=LENGTH, downsample=1))
            for visibility in (WHOLE, "front_final")
        )
    region = whole - outside
    # what float32 leaves of a ray without one
    has_region = region > 1e-4 * whole
    if not has_region.any():
        return bounded.steps
    longer = whole[has_region].sum() / region[has_region].sum()
    return min(max(round(bounded.steps * float(longer)), bounded.steps), RANGES["steps"][1])


def _lengths(renderer: Renderer, technique: Technique) -> NDArray[np.float64]:
    """Length of all lit pieces of each ray, (H, W) [scene unit]."""
    return renderer.render(technique).scattering[..., 0].astype(np.float64)


@contextmanager
def _measures_of_length() -> Iterator[None]:
    """Both are known to the registries meanwhile, and are no techniques otherwise."""
    AIRLIGHT_MODELS[LENGTH] = AirlightShader("<length>", LENGTH, generated=lambda _: TEXTS)
    VISIBILITIES[WHOLE] = Visibility("<whole>", WHOLE)
    try:
        yield
    finally:
        del AIRLIGHT_MODELS[LENGTH], VISIBILITIES[WHOLE]
