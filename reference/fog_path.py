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
# what a surface may do to light other than let it pass
SCATTERING = int(mi.BSDFFlags.All) & ~int(mi.BSDFFlags.Null)


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
    return any(map(_lets_light_pass, scene.shapes()))


def fog_of(scene: Any, medium: Any) -> Any:
    """Return the scene's medium: that of the camera, or for a camera outside it, that of the shape that holds it.

    Raises
    ------
    InputError
        There is none, more than one, or one that is not homogeneous; or a surface that lets light pass is not the
        boundary of a medium inside it, or is more than that.
    """
    shapes = scene.shapes()
    boundaries = [shape for shape in shapes if _lets_light_pass(shape)]
    for shape in boundaries:
        _check_boundary(shape)
    if medium is None and not boundaries:
        raise InputError("The scene has no medium: its camera is in none, and no shape with a null BSDF holds one.")
    fog = boundaries[0].interior_medium() if medium is None else medium
    for shape in shapes:
        if any(other not in (None, fog) for other in (shape.interior_medium(), shape.exterior_medium())):
            raise InputError(
                f"single_scattering takes one medium, and the shape {shape.id()} has another than {fog.id()}: refer to "
                "one and the same."
            )
    if not fog.is_homogeneous():
        raise InputError(f"single_scattering takes a medium of type homogeneous, and {fog.id()} is not: make it one.")
    return fog


def _lets_light_pass(shape: Any) -> bool:
    return bool(shape.bsdf() and mi.has_flag(shape.bsdf().flags(), mi.BSDFFlags.Null))


def _check_boundary(shape: Any) -> None:
    if shape.bsdf().flags() & SCATTERING:
        raise InputError(
            f"single_scattering takes a BSDF that is null or lets no light pass, and that of the shape {shape.id()} "
            "does both: make the shape of one kind, or cut it into parts that are."
        )
    if shape.interior_medium() is None or shape.exterior_medium() is not None:
        raise InputError(
            "single_scattering takes a null BSDF for the boundary of the medium inside a shape, and the shape "
            f"{shape.id()} bounds another place: name the medium as its interior, and nothing as its exterior."
        )


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
