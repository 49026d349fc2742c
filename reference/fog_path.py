"""Ways through a scene whose medium is bounded: what is fog on them, and what stands in them.

A surface with a `null` BSDF bounds a medium and lets light pass. A ray runs along its normal where it leaves the medium
and against it where it enters, so every such surface says by itself what is before and behind it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from scenes.errors import InputError
from scenes.mitsuba_setup import mitsuba

mi = mitsuba()
import drjit as dr  # noqa: E402

# of the distance and of the coordinates: so far behind a boundary the next piece begins, past the rounding of both
STEP = 1e-6


@dataclass(frozen=True)
class FogPath:
    """What a ray meets up to its end.

    Attributes
    ----------
    blocked : Bool        an opaque surface ends it sooner
    t_last : Float        behind the last boundary before its end; 0 without any [scene unit]
    t_end : Float         where it ends: at that surface, or at the ray's `maxt` [scene unit]
    fog_begin : Float     the first place in the medium [scene unit]
    fog_end : Float       the last one; the first again where the ray meets no fog
    fog_length : Float    how much of it is in the medium [scene unit]
    ends_in_fog : Bool    whether its end is in the medium
    """

    blocked: Any
    t_last: Any
    t_end: Any
    fog_begin: Any
    fog_end: Any
    fog_length: Any
    ends_in_fog: Any


def is_bounded(scene: Any) -> bool:
    """Tell whether a shape of the scene lets light pass: then the medium has a boundary."""
    return any(mi.has_flag(shape.bsdf().flags(), mi.BSDFFlags.Null) for shape in scene.shapes() if shape.bsdf())


def fog_of(scene: Any, medium: Any) -> Any:
    """Return the scene's medium: that of the camera, or for a camera outside it, that of the shape that holds it.

    Raises
    ------
    InputError
        There is none.
    """
    if medium is not None:
        return medium
    for shape in scene.shapes():
        if shape.interior_medium() is not None:
            return shape.interior_medium()
    raise InputError("The scene has no medium: neither its camera is in one nor a shape holds one.")


def whole_path(scene: Any, ray: Any, active: Any = True) -> FogPath:
    """Follow a ray through fog that fills space."""
    t = scene.ray_intersect_preliminary(ray, coherent=False, active=active).t
    end = dr.minimum(t, ray.maxt)
    return FogPath(t < ray.maxt, mi.Float(0), end, mi.Float(0), end, end, mi.Bool(True))


def bounded_path(scene: Any, ray: Any, in_fog: Any, active: Any = True) -> FogPath:
    """Follow a ray through a scene whose medium is bounded.

    Parameters
    ----------
    ray : Ray3f      one without end is not in the medium where it meets nothing more, whatever a rounding says
    in_fog : Bool    whether the ray runs in the medium up to the first boundary, if it meets none
    """

    def advance(
        going: Any, t: Any, mark: Any, inside: Any, blocked: Any, last: Any, begin: Any, end: Any, length: Any
    ) -> Any:
        # the next piece is looked for from t on, and counts from the boundary at `mark`, a rounding before it
        rest = mi.Ray3f(ray)
        rest.o, rest.maxt = ray(t), ray.maxt - t
        si = scene.ray_intersect(rest, mi.RayFlags.Minimal, False, going)
        hit = going & si.is_valid()
        passes = hit & mi.has_flag(si.bsdf().flags(), mi.BSDFFlags.Null)
        leaving = dr.dot(si.n, ray.d) > 0
        reached = dr.select(hit, t + si.t, ray.maxt)
        fog = going & dr.select(passes, leaving, inside) & (reached < dr.largest(mi.Float))
        begin = dr.select(fog & (end < 0), mark, begin)
        end = dr.select(fog, reached, end)
        length = dr.select(fog, length + reached - mark, length)
        inside = dr.select(passes, ~leaving, inside)
        behind = reached + STEP * (reached + dr.max(dr.abs(si.p)))
        t = dr.select(passes, behind, dr.select(going, reached, t))
        mark = dr.select(passes, reached, mark)
        last = dr.select(passes, behind, last)
        return passes & (t < ray.maxt), t, mark, inside, blocked | (hit & ~passes), last, begin, end, length

    count = dr.width(ray)
    zero = dr.zeros(mi.Float, count)
    none = dr.zeros(mi.Bool, count)
    state = (none | active, zero, zero, none | in_fog, none, zero, zero, zero - 1, zero)
    _, t, _, inside, blocked, last, begin, end, length = dr.while_loop(state, lambda going, *_: going, advance)
    return FogPath(blocked, last, dr.minimum(t, ray.maxt), begin, dr.maximum(begin, end), length, inside)
