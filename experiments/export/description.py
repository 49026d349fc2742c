"""All of a scene but its surfaces, as JSON can hold it, with units and conventions beside the numbers."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.provenance import describe_files, describe_scene
from gpu_impl.matrices import projection_matrix
from scenes.boundary import Boundary
from scenes.model import Camera, Light, Scene

CONVENTIONS = {
    "matrices": "rows; they act on column vectors (x, y, z, 1)",
    "length": "scene units, as in the scene's file; coefficients are per scene unit",
    "colour": "linear Rec.709 (primaries and white of sRGB, no encoding), scene-referred radiance [W / (m^2 sr)] with "
    "the scene unit for the metre",
    "image": "row 0 at the top; the first pixel spans 0 to 1 in x and y, and its centre is (0.5, 0.5)",
    "sampling": "one ray through each pixel's centre, no filter, no lens; it begins on the near plane and ends on the "
    "first surface or on the far plane, and the fog before the near plane is not seen",
    "transport": "single scattering: light, fog, eye. The surface layer is direct light without bounces, attenuated on "
    "both legs; the scattering layer is light that is scattered once; the composite is their sum",
}
FALLOFF = {
    "point": "intensity / distance^2",
    "spot": "intensity / distance^2, times 1 up to beam_width from the axis, then falling linearly with the angle "
    "((cutoff_angle - angle) / (cutoff_angle - beam_width)) to 0 at cutoff_angle",
    "directional": "the same irradiance everywhere, on a surface that faces the light, attenuated only in the fog",
}
UNITS = {"point": "W / sr", "spot": "W / sr, on the axis", "directional": "W / m^2, an irradiance"}


def describe(scene: Scene) -> dict[str, Any]:
    """Everything that another engine needs beside the surfaces themselves, which the scene's file has."""
    return {
        "conventions": CONVENTIONS,
        "image": {"width": scene.camera.width, "height": scene.camera.height},
        "camera": _camera(scene.camera),
        "medium": _medium(scene),
        "phase": {
            "name": scene.phase.name,
            "parameters": {name: np.asarray(value).tolist() for name, value in asdict(scene.phase).items()},  # type: ignore[call-overload]
            "convention": "1 / sr, over the sphere it integrates to 1; cos theta is between the directions in which "
            "light travels before and after, +1 is forward, and g > 0 scatters forward",
        },
        "lights": [_light(light) for light in scene.lights],
        "surfaces": [
            {
                "name": mesh.name,
                "triangles": len(mesh.faces),
                "least": mesh.vertices.min(axis=0).tolist(),
                "most": mesh.vertices.max(axis=0).tolist(),
                "file": mesh.file.name if mesh.file else None,
            }
            for mesh in scene.meshes
        ],
        "made_by": describe_scene(scene) | describe_files(scene),
    }


def opengl_view(camera: Camera) -> NDArray[np.float64]:
    """World to eye space, looking along -z with +x to the right, (4, 4)."""
    # Mitsuba's camera looks along +z with +x to the left
    return np.diag([-1.0, 1.0, -1.0, 1.0]) @ np.linalg.inv(camera.to_world)


def camera_to_sample(camera: Camera) -> NDArray[np.float64]:
    """Mitsuba's camera space to its film's, (4, 4): x to the right and y downwards from 0 to 1, depth from 0 to 1."""
    depth = camera.far - camera.near
    return np.array(
        [
            [-0.5 / camera.tan_half_x, 0, 0.5, 0],
            [0, -0.5 / camera.tan_half_y, 0.5, 0],
            [0, 0, camera.far / depth, -camera.far * camera.near / depth],
            [0, 0, 1, 0],
        ]
    )


def _camera(camera: Camera) -> dict[str, Any]:
    axes = camera.to_world[:3, :3]
    projection = projection_matrix(camera.tan_half_x, camera.tan_half_y, camera.near, camera.far)
    return {
        "position": camera.origin.tolist(),
        "right": (-axes[:, 0]).tolist(),
        "up": axes[:, 1].tolist(),
        "forward": axes[:, 2].tolist(),
        "fov_x_degrees": float(np.degrees(2 * np.arctan(camera.tan_half_x))),
        "fov_y_degrees": float(np.degrees(2 * np.arctan(camera.tan_half_y))),
        "near": camera.near,
        "far": camera.far,
        "clip_convention": "distances along the viewing axis",
        "opengl": {
            "view": opengl_view(camera).tolist(),
            "projection": projection.tolist(),
            "convention": "clip = projection view world; eye space looks along -z, x to the right, y up; x, y and z of "
            "clip / w from -1 to 1; pixel x = (x + 1) / 2 width, y = (1 - y) / 2 height",
        },
        "mitsuba": {
            "to_world": camera.to_world.tolist(),
            "camera_to_sample": camera_to_sample(camera).tolist(),
            "fov_axis": "x",
            "convention": "camera space looks along +z, x to the left, y up; x and y of sample / w from 0 to 1, times "
            "width and height",
        },
    }


def _medium(scene: Scene) -> dict[str, Any]:
    medium = scene.medium
    return {
        "sigma_s": medium.sigma_s.tolist(),
        "sigma_t": medium.sigma_t.tolist(),
        "unit": "1 / scene unit; one number, or three for Rec.709's channels; homogeneous",
        "boundary": _boundary(scene.boundary),
    }


def _boundary(boundary: Boundary | None) -> dict[str, Any] | str:
    if boundary is None:
        return "none: the fog fills space"
    if boundary.ball is not None:
        return {"centre": boundary.ball[:3].tolist(), "radius": float(boundary.ball[3])}
    return {"planes": boundary.planes.tolist(), "convention": "(n, o): inside is n . x <= o for every plane"}


def _light(light: Light) -> dict[str, Any]:
    found: dict[str, Any] = {
        "kind": light.kind,
        "intensity": light.intensity.tolist(),
        "unit": UNITS[light.kind],
        "falloff": FALLOFF[light.kind],
    }
    if light.kind != "directional":
        found["position"] = light.position.tolist()
    if light.kind != "point":
        found["direction"] = light.direction.tolist()
    if light.kind == "spot":
        found["beam_width_degrees"] = float(np.degrees(light.beam_width))
        found["cutoff_angle_degrees"] = float(np.degrees(light.cutoff_angle))
    if light.texture is not None:
        found["to_world"] = light.to_world.tolist()
        found["picture"] = light.texture.path.name
    return found
