"""The registry of visibility strategies. A new one is a file under `shaders/visibility` and a line here.

One that needs more than ray, light and shadow map has a module beside this one that makes it (`strategy.Supply`).
"""

from __future__ import annotations

from dataclasses import replace

from gpu_impl.passes.shadow_volume import check_polygons
from gpu_impl.visibilities.blue_noise import BlueNoise
from gpu_impl.visibilities.exact import ShadowPyramid
from gpu_impl.visibilities.min_max import MinMax
from gpu_impl.visibilities.shadow_faces import ShadowFaces, check_faces
from gpu_impl.visibilities.shadow_polygons import printed, repaired
from gpu_impl.visibilities.slices import slices
from gpu_impl.visibilities.strategy import Visibility

__all__ = ["VISIBILITIES", "Visibility"]

VISIBILITIES = {
    "uniform_march": Visibility("visibility/uniform_march.glsl", "equal steps over the ray"),
    "uniform_march:jittered": Visibility(
        "visibility/uniform_march_jittered.glsl",
        "equal steps, each ray's samples shifted by interleaved gradient noise (Jimenez 2014)",
    ),
    "uniform_march:blue_noise": Visibility(
        "visibility/uniform_march_blue_noise.glsl",
        "equal steps, each ray's samples shifted by a tile of blue noise (Ulichney 1993)",
        supply=BlueNoise,
    ),
    "lit_intervals": Visibility(
        "visibility/lit_intervals.glsl",
        "samples between the first and the last shadow polygon, merged to lit intervals (Algorithms 4.1 and 4.2 "
        "repaired)",
        supply=repaired,
        grid_only=True,
        check=check_polygons,
    ),
    "lit_intervals:printed": Visibility(
        "visibility/lit_intervals_printed.glsl",
        "Algorithms 4.1 and 4.2 as printed",
        supply=printed,
        grid_only=True,
        check=check_polygons,
    ),
    "lit_intervals:unbounded": Visibility(
        "visibility/lit_intervals_unbounded.glsl",
        "samples over all of the ray that the light reaches, merged to lit intervals (Algorithm 4.1 repaired)",
    ),
    "bounded_march": Visibility(
        "visibility/bounded_march.glsl",
        "equal steps between the first and the last shadow polygon, one piece each (Wyman and Ramsey 2008)",
        supply=repaired,
        grid_only=True,
        check=check_polygons,
    ),
    "front_final": Visibility(
        "visibility/front_final.glsl",
        "dark between the first and the last shadow polygon (Figure 1.1)",
        supply=repaired,
        grid_only=True,
        check=check_polygons,
    ),
    "min_max": Visibility(
        "visibility/min_max.glsl",
        "the rectified shadow map, whose rows have trees of least and largest thresholds (Chen et al. 2011)",
        supply=MinMax,
    ),
    "exact": Visibility(
        "visibility/exact.glsl",
        "every texel of the shadow map that the ray crosses, by a pyramid of least and largest distances: a control",
        supply=ShadowPyramid,
        asks_points=False,
    ),
    "shadow_faces": Visibility(
        "visibility/shadow_faces.glsl",
        "the whole ray, less and more behind each face of a shadow volume, unsorted (James 2003)",
        supply=ShadowFaces,
        vertex="visibility/shadow_faces.vert.glsl",
        reads_shadow_map=False,
        asks_points=False,
        grid_only=True,
        check=check_faces,
    ),
    "slices": slices(8),
    # nothing interpolated, and too much of it: what the cells do
    "slices:1": slices(1),
    "slices:32": slices(32),
    # not the paper's: what slices outside a spot's cone are worth
    "slices:beam": slices(8, in_beam=True),
    "given": Visibility(
        "visibility/given.glsl",
        "the lit intervals that the reference's ray casting found: a control",
        reads_shadow_map=False,
        asks_points=False,
        given=True,
    ),
}
VISIBILITIES |= {
    f"{name}:steps": replace(
        VISIBILITIES[name],
        what=f"the pieces of {name}, cut into steps for models that sample points: a control",
        in_steps=True,
    )
    for name in ("exact", "given")
}
