"""Small Mitsuba scenes written for one test."""

from __future__ import annotations

from pathlib import Path

from scenes.loader import load
from scenes.model import Scene

POINT = (
    "<emitter type='point'><point name='position' x='0.3' y='2.6' z='0'/><float name='intensity' value='10'/></emitter>"
)


def write_scene(
    folder: Path,
    emitters: str = POINT,
    shapes: str = "",
    size: tuple[int, int] = (64, 64),
    sigma_t: str = "<float name='sigma_t' value='0.1'/>",
    phase: str = "<phase type='isotropic'/>",
    eye: str = "0, 0, 5",
    far: float = 25,
    near: float = 0.01,
    inside: bool = True,
) -> Scene:
    """Load a scene of `emitters` and `shapes` in fog, seen from `eye`, which is `inside` it, towards the origin."""
    path = folder / "scene.xml"
    path.write_text(
        f"""<scene version='3.0.0'>
          <medium type='homogeneous' id='fog'>{sigma_t}<float name='albedo' value='0.9'/>{phase}</medium>
          <sensor type='perspective'>
            <float name='fov' value='45'/><float name='far_clip' value='{far}'/><float name='near_clip' value='{near}'/>
            <transform name='to_world'><lookat origin='{eye}' target='0, 0, 0' up='0, 1, 0'/></transform>
            <film type='hdrfilm'/>{"<ref id='fog'/>" * inside}
          </sensor>
          {emitters}{shapes}
        </scene>""",
        encoding="utf-8",
    )
    return load(path, size=size)


def point(x: float, y: float, z: float, intensity: str = "<float name='intensity' value='10'/>") -> str:
    """A point light."""
    return f"<emitter type='point'><point name='position' x='{x}' y='{y}' z='{z}'/>{intensity}</emitter>"


def spot(origin: str, target: str, cutoff: float, beam: float, intensity: float = 30) -> str:
    """A spot light."""
    return (
        f"<emitter type='spot'><float name='intensity' value='{intensity}'/>"
        f"<float name='cutoff_angle' value='{cutoff}'/><float name='beam_width' value='{beam}'/>"
        f"<transform name='to_world'><lookat origin='{origin}' target='{target}' up='0, 0, 1'/></transform></emitter>"
    )


def sphere(x: float, y: float, z: float, radius: float) -> str:
    """A sphere."""
    return (
        f"<shape type='sphere'><point name='center' x='{x}' y='{y}' z='{z}'/><float name='radius' value='{radius}'/>"
        "</shape>"
    )


# origin, target and half-angle of the cone [degrees]
SPOTS = {
    "down": ("0.3, 3.5, 0", "0, 0, 0", 24),
    "towards the eye": ("0.2, 0.5, -3", "0, 0.2, 5", 30),
    "away from the eye": ("0.4, 0.6, 5.5", "0, 0, -3", 20),
    "wide": ("0.3, 2, 0", "0, 0, 0.5", 75),
    "too wide to bound": ("0.3, 2, 0", "0, 0, 0.5", 89),
}
# rays that point at the light or away from it, where float32 has no digits left for the angle between two distances
COLLINEAR = {
    "at the eye": {"emitters": point(0, 0, 5)},
    "at the eye, thin fog, Mitsuba's own clips": {
        "emitters": point(0, 0, 5),
        "sigma_t": "<float name='sigma_t' value='0.001'/>",
        "far": 1e4,
    },
    "behind the eye": {"emitters": point(0, 1e-3, 9)},
    "far off, and a short piece": {
        "emitters": point(0, 3e4, 5),
        "sigma_t": "<float name='sigma_t' value='1e-5'/>",
        "near": 5,
        "far": 5.5,
    },
}
