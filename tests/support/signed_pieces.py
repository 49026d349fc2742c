"""Shadow-volume faces' signed pieces, beside the lit intervals that the reference's rays find."""

from __future__ import annotations

import numpy as np

from gpu_impl.recording import Pieces
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from reference.deterministic import lit_intervals
from scenes.model import Scene

FACES = "shadow_faces+quadrature"
# half its side, and its middle
CUBE = (
    "<shape type='cube'><transform name='to_world'><scale value='{0}'/><translate x='{1}' y='{2}' z='{3}'/></transform>"
    "</shape>"
)
SUN = (
    "<emitter type='directional'><vector name='direction' value='0.6, -1, -0.3'/>"
    "<rgb name='irradiance' value='3, 2, 1'/></emitter>"
)
BODY_OF_FOG = (
    "<shape type='cube'><bsdf type='null'/><ref name='interior' id='fog'/>"
    "<transform name='to_world'><scale x='3' y='2' z='2'/></transform></shape>"
)


def lit_lengths(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Lit length of each ray, as the faces' signed pieces have it and as the reference's rays do, (H W,) each.

    The scene has one light.
    """
    with Renderer(scene) as renderer:
        (pieces,) = renderer.record(find_technique(FACES, shadow_map=4))
    found = lit_intervals(scene)
    count = scene.camera.width * scene.camera.height
    return signed_lengths(pieces), np.bincount(found.pixel, found.end - found.begin, minlength=count)


def signed_lengths(pieces: Pieces) -> np.ndarray:
    """Pieces' lengths times their weights, added up for each cell, in float64: most are long, and cancel."""
    return np.bincount(pieces.cell, pieces.w.astype(np.float64) * pieces.dt, minlength=pieces.start.size)
