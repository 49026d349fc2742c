"""Lights all around the eye of `scene_files.write_scene`, which is at (0, 0, 5) and looks at the origin."""

from __future__ import annotations

import numpy as np
from scene_files import SPOTS, point, spot

# half the width of what the eye sees at the origin
EDGE = 5 * float(np.tan(np.radians(22.5)))
BOX = (
    "<shape type='cube'><bsdf type='null'/><ref name='interior' id='fog'/>"
    "<transform name='to_world'><scale value='9'/></transform></shape>"
)


def sun(direction: str) -> str:
    """A directional light, and the box that it needs."""
    return (
        f"{BOX}<emitter type='directional'><vector name='direction' value='{direction}'/>"
        "<rgb name='irradiance' value='3'/></emitter>"
    )


POINTS = {
    "in the picture": point(0.8, 0.7, -1),
    "in its corner": point(EDGE, EDGE, 0),
    "beside it": point(3, 1.5, 0),
    "behind the eye": point(-1, 0.8, 7),
    "the eye looks at it": point(0, 0, -2),
    "the eye looks away from it": point(0, 0, 8),
    "above the eye": point(0, 3, 5),
    "beside the eye": point(2, 0, 5),
    "at the eye": point(0, 0, 5),
    "far": point(50, 80, -30, "<float name='intensity' value='90000'/>"),
}
HARD_SPOTS = {f"spot {name}": spot(origin, target, angle, angle) for name, (origin, target, angle) in SPOTS.items()}
SUNS = {
    "sun beside": sun("0.5, -1, -0.3"),
    "sun behind": sun("0.1, -0.2, -1"),
    "sun in the picture": sun("0.3, -0.2, 1"),
    "sun along the view": sun("0, 0, -1"),
    "sun against the view": sun("0, 0, 1"),
    "sun level with the image": sun("1, 0, 0"),
    "sun overhead": sun("0, -1, 0"),
}
PLACES = POINTS | HARD_SPOTS | SUNS
