"""The table of known answers: small scenes whose airlight mpmath gives, in the spirit of pbrt-v4's analytic scenes.

A row is a scene and why it is there; everything else follows from it: the scene file, the lit pieces, the airlight. To
add one, add a `Case` to `CASES`; every estimator and phase function then takes it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from exact_airlight import cornette_shanks, henyey_greenstein, isotropic, rayleigh, schlick, tabulated
from known_airlight import Fog, airlight
from lit_pieces import Ball, Box, Cone, Plate, lit_pieces, rays_of
from scene_files import point, spot

from analytic import phase
from analytic.phase import Phase
from scenes.model import Light, Scene

TABLE = (1.0, 0.4, 0.7, 2.0, 6.0)
PHASES: dict[str, tuple[str, Phase, Callable[[Any], Any]]] = {
    "isotropic": ("", phase("isotropic"), isotropic),
    "rayleigh": ("", phase("rayleigh"), rayleigh),
    "hg0.6": ("<float name='g' value='0.6'/>", phase("hg", g=0.6), henyey_greenstein(0.6)),
    "hg-0.6": ("<float name='g' value='-0.6'/>", phase("hg", g=-0.6), henyey_greenstein(-0.6)),
    "hg0.9": ("<float name='g' value='0.9'/>", phase("hg", g=0.9), henyey_greenstein(0.9)),
    "schlick": ("<float name='k' value='0.7'/>", phase("schlick", k=0.7), schlick(0.7)),
    "cornette_shanks": ("<float name='g' value='0.6'/>", phase("cornette_shanks", g=0.6), cornette_shanks(0.6)),
    "tabphase": (
        f"<string name='values' value='{str(TABLE)[1:-1]}'/>",
        phase("tabulated", values=TABLE),
        tabulated(TABLE),
    ),
}

SIDES = (4, 3)
LIGHT = point(0.8, 1.5, 1)
SUN = (
    "<emitter type='directional'><vector name='direction' value='0.6, -1, -0.3'/>"
    "<rgb name='irradiance' value='3, 2, 1'/></emitter>"
)
SLAB = Box((100, 0.75, 100))


def grey(sigma_t: float) -> str:
    """An extinction coefficient."""
    return f"<float name='sigma_t' value='{sigma_t}'/>"


def coloured(*sigma_t: float) -> str:
    """An extinction coefficient for each of red, green and blue."""
    return f"<rgb name='sigma_t' value='{str(sigma_t)[1:-1]}'/>"


@dataclass(frozen=True)
class Case:
    """One row of the table.

    Attributes
    ----------
    why : str                        what it is there for
    lights : str                     Mitsuba's emitters
    occluders : tuple                black balls and plates
    sigma_t : str                    the medium's property
    albedo : float                   of the medium
    box : Box or None                what holds the fog; None where it fills space
    eye, target : str                of the camera
    outside : bool                   whether the camera is outside the box
    fov, near, far : float           of the camera [degree, scene unit]
    rounding : float                 what float32 does to the answer, relative, as one standard error
    no_volpath : str                 why Mitsuba's `volpath` cannot say anything here; empty where it can
    """

    why: str
    lights: str = LIGHT
    occluders: tuple[Ball | Plate, ...] = ()
    sigma_t: str = grey(0.2)
    albedo: float = 0.9
    box: Box | None = None
    eye: str = "0, 0, 5"
    target: str = "0, 0, 0"
    outside: bool = False
    fov: float = 20
    near: float = 0.01
    far: float = 15
    # measured: at most 1.6e-6 (towards_the_light) is needed
    rounding: float = 2e-6
    no_volpath: str = ""

    def write(self, path: Path, phase_name: str, fov: float | None = None) -> Path:
        """Write the scene's file, with another field of view where one is given."""
        kind = next(kind for kind in ("hg", phase_name) if phase_name.startswith(kind))
        shapes = "".join(occluder.xml() for occluder in self.occluders) + (self.box.xml() if self.box else "")
        path.write_text(
            f"""<scene version='3.0.0'>
              <medium type='homogeneous' id='fog'>{self.sigma_t}<float name='albedo' value='{self.albedo}'/>
                <phase type='{kind}'>{PHASES[phase_name][0]}</phase></medium>
              <sensor type='perspective'><float name='fov' value='{fov or self.fov}'/>
                <float name='near_clip' value='{self.near}'/><float name='far_clip' value='{self.far}'/>
                <transform name='to_world'><lookat origin='{self.eye}' target='{self.target}' up='0, 1, 0'/></transform>
                <film type='hdrfilm'/>{"" if self.outside else "<ref id='fog'/>"}</sensor>
              {self.lights}{shapes}</scene>"""
        )
        return path


TOO_CLOSE = "the variance of a path grows with 1 over the distance at which the ray passes the light"
# a lamp above the gap, seen from the side: the edges' planes cut every ray
FROM_THE_SIDE = {"eye": "2.5, 0.3, 4", "target": "-0.5, -0.3, 0", "far": 9}

BRIGHT = "<float name='intensity' value='1e15'/>"

CASES = {
    "no_occluder": Case("the integrand alone"),
    "coloured_fog": Case(
        "each channel has an extinction of its own",
        sigma_t=coloured(0.05, 0.2, 0.8),
        no_volpath="it draws distances by one channel and never weighs the others: few paths carry most of the light",
    ),
    "two_lights": Case(
        "they add up, each in its colour",
        point(0.8, 1.5, 1, "<rgb name='intensity' value='3, 5, 1'/>")
        + point(-2, -0.5, -1, "<rgb name='intensity' value='1, 2, 8'/>"),
    ),
    "half_plane": Case(
        "one edge: a ray is lit up to a plane or from it on",
        point(0.8, 3, 0.5),
        (Plate(1.5, -60, 0.2),),
        **FROM_THE_SIDE,
    ),
    "plate_from_above": Case(
        "rays that the plate hides only once they are below it",
        point(0.1, 3, 0.5),
        (Plate(1.5, -60, 0.2),),
        eye="2.5, 2.6, 4",
        target="0, 1, 0",
        far=9,
    ),
    "slit": Case(
        "two edges: light between two dark pieces",
        point(0.1, 3, 0.5),
        (Plate(1.5, -60, -0.3), Plate(1.5, 0.3, 60)),
        **FROM_THE_SIDE,
    ),
    "sphere_on_the_axis": Case(
        "some rays end on it, others cross its shadow", point(0.9, 1.4, 0.6), (Ball((0, 0, 0), 0.4),)
    ),
    "light_behind_the_eye": Case(
        "rays that run along a shadow for long", point(0.4, 0.6, 7), (Ball((0, 0.45, 4), 0.2),)
    ),
    "eye_in_shadow": Case("rays begin in the dark", point(0, 2.6, 2), (Ball((0, 1.3, 3.5), 0.5),)),
    "spot_across": Case("a hard cone: rays through it and past it", spot("0.3, 2.5, 0", "0, 0, 0", 12, 12)),
    "spot_grazing": Case(
        "a hard cone, grazed, and missed by a hundredth",
        spot("0, 2, 0", "0, 0, 0", 20, 20),
        eye="0.7, 0, 5",
        target="0.7, 0, 0",
        fov=1,
        # float32 makes the shortest chord, of 0.14, 1.1e-4 too short, and its end is met by few samples
        rounding=2e-5,
    ),
    "spot_along_its_side": Case(
        "a hard cone, along its side for the whole ray",
        spot("0.1, 0, 6", f"{0.1 + 6 * np.tan(np.radians(20))}, 0, 0", 20, 20),
        eye="0.12, 0, 5",
        target="0.12, 0, 0",
        fov=0.5,
    ),
    "soft_spot": Case("the falloff between two cones", spot("0.3, 2.5, 0", "0, 0, 0", 24, 8)),
    "towards_the_light": Case("rays that end before the light that they point at", point(0, 0, 0), fov=2, far=3.5),
    "away_from_the_light": Case("rays from a light behind them, away from it", point(0, 0, 6), fov=2),
    "ball_before_the_light": Case("an eclipse: rays end in the dark", point(0, 0, 0), (Ball((0, 0, 1.5), 0.3),)),
    "past_the_light_at_0.1": Case("rays almost through the light", point(0.1, 0, 0), fov=0.4),
    "past_the_light_at_0.01": Case("closer", point(0.01, 0, 0), fov=0.04, no_volpath=TOO_CLOSE),
    "past_the_light_at_0.001": Case("closer still", point(0.001, 0, 0), fov=0.004, no_volpath=TOO_CLOSE),
    "thick_1": Case("an optical depth of 1 from eye to light", point(1.6, 1.2, 5), sigma_t=grey(0.5)),
    **{
        f"thick_{depth}": Case(
            f"an optical depth of {depth} from eye to light",
            point(1.6, 1.2, 5, BRIGHT),
            sigma_t=grey(depth / 2),
            no_volpath="of its shadow rays only e^-depth arrive",
        )
        for depth in (10, 50, 100)
    },
    "slab_from_above": Case(
        "the sun on a slab of fog, from outside",
        SUN,
        box=SLAB,
        eye="0, 4, 5",
        target="0.3, 0, 0",
        outside=True,
        far=300,
    ),
    "slab_from_within": Case(
        "the sun through a slab of fog, into the light", SUN, box=SLAB, eye="0, 0, 0", target="-1, 1.2, 0.4", far=300
    ),
    "slab_coloured": Case(
        "the sun on a slab of coloured fog",
        SUN,
        sigma_t=coloured(0.05, 0.4, 1),
        box=SLAB,
        eye="0, 0.5, 0",
        target="3, -0.8, 0",
        far=300,
    ),
    "cube_from_outside": Case(
        "fog that ends, a lamp above it", point(0.1, 3, -0.2), box=Box((1, 1, 1)), eye="0.7, 0.6, 5", outside=True
    ),
    "cube_from_within": Case("the same from inside", point(0.1, 3, -0.2), box=Box((1, 1, 1)), eye="0.2, 0.1, 0.8"),
}


def truth(case: Case, scene: Scene, phase_name: str, light_share: float = 1.0) -> np.ndarray:
    """Airlight of the case's scene, (H, W, 3)."""
    _, library, exact = PHASES[phase_name]
    sigma_s, sigma_t = (np.broadcast_to(s, 3).astype(float) for s in (scene.medium.sigma_s, scene.medium.sigma_t))
    fog = Fog(sigma_s, sigma_t, library, exact, case.box, light_share)

    def one_ray(ray: Any, light: Light) -> np.ndarray:
        within = case.box.within(ray) if case.box else (0.0, ray.end)
        limits = [*case.occluders, *([Cone()] if light.kind == "spot" else [])]
        return airlight(fog, light, ray, lit_pieces(ray, light, limits, within), within[0])

    rays = rays_of(scene.camera, case.occluders)
    values = [sum(one_ray(ray, light) for light in scene.lights) for ray in rays]
    return np.reshape(values, (scene.camera.height, scene.camera.width, 3))
