"""The fog of a scene file: its coefficients, its phase function and what holds it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import analytic
from analytic.phase import Phase
from scenes import boundary
from scenes.boundary import Boundary
from scenes.meshes.triangles import Triangles
from scenes.model import Camera, Mesh
from scenes.shapes import SUPPORTED, load_shape
from scenes.xml_nodes import Node


def load_medium(node: Node) -> tuple[analytic.Medium, Phase]:
    """Read a `homogeneous` medium.

    Raises
    ------
    InputError
        Another plugin, a property that airlight does not know, or values that no medium can have.
    """
    if node.plugin != "homogeneous":
        raise node.refuse("is not supported; use homogeneous.")
    scale = node.number("scale", 1.0)
    is_colour = "sigma_t" in node.unread and not isinstance(node.props["sigma_t"], int | float)
    colour = node.color("sigma_t", 1.0)
    if is_colour and (colour > 1).any():
        raise node.refuse(f"has 'sigma_t' = {colour.tolist()}; Mitsuba takes colours of at most 1: use a 'scale' too.")
    albedo = node.color("albedo", 0.75)
    phase_node = node.child("PhaseFunction")
    node.ignore("sample_emitters", "has_spectral_extinction")
    node.finish()
    try:
        return analytic.Medium.from_albedo(albedo, colour * scale), load_phase(phase_node)
    except ValueError as error:
        raise node.refuse(f"cannot be used: {error}.") from None


def _table(node: Node) -> tuple[float, ...]:
    try:
        return tuple(float(word) for word in node.text("values").replace(",", " ").split())
    except ValueError:
        raise node.refuse("has 'values' that are not numbers apart by commas or spaces.") from None


# what each plugin takes, and the name of the function in `analytic.phase`
PHASES: dict[str, tuple[str, Callable[[Node], dict]]] = {
    "isotropic": ("isotropic", lambda node: {}),
    "rayleigh": ("rayleigh", lambda node: {}),
    "hg": ("hg", lambda node: {"g": node.number("g", 0.8)}),
    "schlick": ("schlick", lambda node: {"k": node.number("k", 0.5)}),
    "cornette_shanks": ("cornette_shanks", lambda node: {"g": node.number("g", 0.8)}),
    "tabphase": ("tabulated", lambda node: {"values": _table(node)}),
}


def load_phase(node: Node | None) -> Phase:
    """Read a phase function; Mitsuba's default is isotropic.

    Raises
    ------
    InputError
        Another plugin, a property that airlight does not know, or values that it cannot have.
    """
    if node is None:
        return analytic.phase("isotropic")
    if node.plugin not in PHASES:
        *names, last = PHASES
        raise node.refuse(f"is not supported; use {', '.join(names)} or {last}.")
    name, settings = PHASES[node.plugin]
    values = settings(node)
    node.finish()
    try:
        return analytic.phase(name, **values)
    except ValueError as error:
        raise node.refuse(f"cannot be used: {error}.") from None


@dataclass(frozen=True)
class Fog:
    """The one medium of a scene.

    Attributes
    ----------
    medium : Node
    boundary : Boundary or None    what holds it; None where it fills space
    """

    medium: Node
    boundary: Boundary | None

    def check_faces(self, node: Node, mesh: Mesh) -> None:
        """Refuse a surface that lies in a face of the shape that holds the medium: Mitsuba steps over it."""
        if self.boundary is None or self.boundary.ball is not None:
            return
        size = float(np.linalg.norm(np.ptp(self.boundary.corners, axis=0)))
        vertices = mesh.vertices.astype(np.float64)
        for plane in self.boundary.planes:
            flush = (np.abs(vertices @ plane[:3] - plane[3]) < boundary.TOLERANCE * size)[mesh.faces].all(axis=1)
            others = self.boundary.planes[(self.boundary.planes != plane).any(axis=1)]
            # a face that only shares an edge with the body has no area in common
            inner = others - np.array([0, 0, 0, boundary.TOLERANCE * size])
            if any(len(boundary.clipped(vertices[face], inner)) for face in mesh.faces[flush]):
                raise node.refuse("lies in a face of the shape that holds the medium: move one of them a little.")

    def check_outside(self, shape: Node) -> None:
        """Take a surface's 'exterior', which may only repeat that it stands in fog that fills space."""
        exterior = shape.nested("exterior")
        if exterior is None:
            return
        if self.boundary is not None or exterior.index != self.medium.index:
            raise exterior.refuse(
                f"is the 'exterior' of the {shape.plugin}, where airlight takes only the fog that fills space; leave "
                "it out: a surface inside a bounded medium needs none."
            )


def take_fog(sensor: Node, camera: Camera, around: Node | None, shapes: list[Node], scene_folder: Path) -> Fog:
    """Find the medium: the camera's where it fills space, or that of the shape that holds it.

    Parameters
    ----------
    around : the camera's medium
    shapes : the one that holds the medium is taken out

    Raises
    ------
    InputError
        There is no medium, or more than one; what holds it is not a closed convex body; or the camera is inside it and
        does not say so, or the other way round.
    """
    holders = [node for node in shapes if _bsdf_plugin(node) == "null"]
    if not holders:
        if around is None:
            raise sensor.refuse(
                "is not inside a medium, so there is no fog to render: put <ref id='...'/> of a medium in it, or put "
                "the fog into a shape with a null BSDF."
            )
        return Fog(around, None)
    if len(holders) > 1:
        raise holders[1].refuse("is a second shape with a null BSDF; airlight takes one bounded medium.")
    shapes.remove(holders[0])
    medium, held = _bounded(holders[0], scene_folder)
    if around is not None and around.index != medium.index:
        raise around.refuse("is a second medium; airlight takes one.")
    _check_camera(sensor, camera, around is not None, held)
    return Fog(medium, held)


def _bounded(node: Node, scene_folder: Path) -> tuple[Node, Boundary]:
    """The medium inside a shape with a null BSDF, and the shape's body."""
    if node.plugin not in SUPPORTED:
        raise node.refuse(f"cannot hold a medium; use one of {', '.join(SUPPORTED)}.")
    medium = node.nested("interior")
    if medium is None or medium.kind != "Medium":
        raise node.refuse("has a null BSDF and holds no medium: put <ref name='interior' id='...'/> of one in it.")
    if node.nested("exterior") is not None:
        raise node.refuse("has an 'exterior' medium, and airlight takes none around a bounded one; leave it out.")
    for bsdf in node.children("BSDF"):
        bsdf.finish()
    shape = load_shape(node, scene_folder, "boundary")
    if node.plugin == "sphere":
        outward = shape.mesh.vertices - shape.to_world[:3, 3]
        if shape.mesh.normals is not None and (shape.mesh.normals * outward).sum() < 0:
            raise node.refuse(f"looks inward, so its interior is all of space: {boundary.INWARD}.")
        radius = float(np.cbrt(abs(np.linalg.det(shape.to_world[:3, :3]))))
        return medium, boundary.ball(shape.to_world[:3, 3], radius)
    try:
        return medium, boundary.convex_hull(Triangles(shape.mesh.vertices, shape.mesh.faces))
    except ValueError as error:
        raise node.refuse(f"cannot hold a medium: {error}.") from None


def _bsdf_plugin(node: Node) -> str:
    """Plugin of a shape's BSDF, which stays unread; empty where it has none."""
    unread = dict(node.unread)
    found = node.children("BSDF")
    node.unread = unread
    return found[0].plugin if found else ""


def _check_camera(sensor: Node, camera: Camera, says_inside: bool, holder: Boundary) -> None:
    """Refuse a camera that does not say whether it is in the fog, or whose clip planes cut the fog.

    Mitsuba would draw these wrongly without a word: the first without fog or with fog that does not end, the second
    beyond its far plane.
    """
    # rays begin on this rectangle
    corners = np.array([[x, y, 1.0] for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    corners *= camera.near * np.array([camera.tan_half_x, camera.tan_half_y, 1.0])
    near = corners @ camera.to_world[:3, :3].T + camera.origin
    touched, inside = holder.meets(near), bool(holder.contains(near).all())
    if touched and not inside:
        raise sensor.refuse(
            "has a near plane that cuts the shape that holds the medium: change near_clip or move the camera."
        )
    if says_inside and not inside:
        raise sensor.refuse("has a medium, and is outside the shape that holds it: take the medium out of the camera.")
    if not says_inside and inside:
        raise sensor.refuse("is inside the shape that holds the medium: put <ref id='...'/> of the medium in it.")
    first, last = holder.depths(camera.origin, camera.to_world[:3, 2])
    if not inside and first < camera.far < last:
        raise sensor.refuse(
            f"has a far plane that cuts the shape that holds the medium: use a far_clip above {last:.4g}."
        )
