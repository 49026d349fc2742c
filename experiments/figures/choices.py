"""Which rays the diagrams are drawn of: the best of a picture's by a stated score, chosen by no hand."""

from __future__ import annotations

import numpy as np

from experiments.figures.rays import DrawnRay, RayField
from experiments.figures.stage import Stage

# the subject of Figure 5.1 (left): a ray through the donut's two sides is in shadow, in light and in shadow again
SUBJECT = "donut_dragon"


def _shortest(field: RayField, pixel: int, pieces: int) -> float:
    """The shortest piece, lit or dark, of a ray with so many lit ones [scene unit]."""
    lit = field.pieces(pixel)
    if len(lit) != pieces:
        return -np.inf
    return float(np.diff(lit.ravel()).min())


def two_shadows(stage: Stage) -> DrawnRay:
    """The ray with lit, dark, lit, dark and lit pieces whose shortest is longest."""
    return stage.field(SUBJECT).best(lambda field, pixel: _shortest(field, pixel, 3))


def one_shadow(stage: Stage) -> DrawnRay:
    """The ray with one dark piece between lit ones, the shortest of which is longest, that passes the light."""

    def score(field: RayField, pixel: int) -> float:
        found = _shortest(field, pixel, 2)
        return found if found > 0 and 0 < field.x_h[pixel] < field.end.flat[pixel] else -np.inf

    return stage.field(SUBJECT).best(score)


def no_shadow(stage: Stage) -> DrawnRay:
    """The ray without a shadow polygon whose lit piece is longest."""

    def score(field: RayField, pixel: int) -> float:
        has_polygon = np.isfinite(field.polygons.reshape(-1, 2)[pixel, 0])
        return -np.inf if has_polygon else _shortest(field, pixel, 1)

    return stage.field(SUBJECT).best(score)


def many_shadows(stage: Stage, scene: str, pieces: int) -> DrawnRay:
    """The ray with so many lit pieces whose shortest piece is longest."""
    return stage.field(scene).best(lambda field, pixel: _shortest(field, pixel, pieces))


def projection_before_the_eye(stage: Stage) -> DrawnRay:
    """The ray with the light furthest behind the eye, for its length."""
    return stage.field("light_behind_eye").best(lambda field, pixel: -field.x_h[pixel] / field.end.flat[pixel])


def projection_behind_the_surface(stage: Stage) -> DrawnRay:
    """The ray that ends before it would pass the light: by the shorter of what it lacks and what of it is lit."""

    def score(field: RayField, pixel: int) -> float:
        lacks = field.x_h[pixel] - field.end.flat[pixel]
        lit = np.diff(field.pieces(pixel)).sum()
        return float(min(lacks, lit)) if lacks > 0 and lit > 0 else -np.inf

    return stage.field("dragon").best(score)
