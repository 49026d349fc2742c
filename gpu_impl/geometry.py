"""A scene's triangles on the GPU."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from gpu_impl.closed_mesh import distance_to_box, outward_side
from gpu_impl.device import Device
from gpu_impl.shader_source import set_uniforms
from gpu_impl.textures import PictureTextures
from scenes.model import Array, Mesh, Scene, Texture

# how geometry.frag.glsl numbers `Mesh.mapping`
MAPPINGS = ("uv", "sphere", "cylinder", "disk")


class MeshBuffers:
    """Vertex and index buffers of one mesh."""

    def __init__(self, context: Any, mesh: Mesh) -> None:
        vertices, normals, faces = mesh.vertices, mesh.normals, mesh.faces
        self._box = vertices.min(axis=0), vertices.max(axis=0)
        self._outward_side = outward_side(vertices, faces)
        if normals is None:
            # a flat face shares its vertices with no other
            vertices = vertices[faces].reshape(-1, 3)
            corners = vertices.reshape(-1, 3, 3).astype(np.float64)
            flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            length = np.linalg.norm(flat, axis=1, keepdims=True)
            normals = np.repeat(flat / np.where(length > 0, length, 1), 3, axis=0)
            faces = np.arange(len(vertices), dtype=np.uint32)
        self._context = context
        self._positions = context.buffer(np.ascontiguousarray(vertices, np.float32))
        self._normals = context.buffer(np.ascontiguousarray(normals, np.float32))
        self._indices = context.buffer(np.ascontiguousarray(faces, np.uint32))
        self.material = mesh.material
        self.has_picture = isinstance(mesh.material.diffuse, Texture)
        self._coordinates = None
        if mesh.coordinates is not None and self.has_picture:
            coordinates = mesh.coordinates if mesh.normals is not None else mesh.coordinates[mesh.faces].reshape(-1, 3)
            self._coordinates = context.buffer(np.ascontiguousarray(coordinates, np.float32))
        self._mapping = MAPPINGS.index(mesh.mapping)

    def draw(self, program: Any, uniforms: Mapping[str, Any], eye: Array | None, reach: float = 0.0) -> None:
        """Draw with the attributes that the program has.

        Parameters
        ----------
        eye : (3,) or None    where it is seen from; None from infinitely far
        reach : float         how far from there something may be clipped away [scene unit]
        """
        attributes = [(self._positions, "3f", "in_position")]
        if "in_normal" in program:
            attributes.append((self._normals, "3f", "in_normal"))
        if "in_coordinates" in program and self._coordinates:
            attributes.append((self._coordinates, "3f", "in_coordinates"))
        set_uniforms(program, uniforms)
        array = self._context.vertex_array(program, attributes, self._indices)
        if self._outward_side and (eye is None or distance_to_box(eye, *self._box) > reach):
            self._context.cull_face = "back" if self._outward_side > 0 else "front"
            self._context.enable(self._context.CULL_FACE)
        array.render()
        self._context.disable(self._context.CULL_FACE)
        array.release()

    def release(self) -> None:
        """Give the buffers back."""
        for buffer in (self._positions, self._normals, self._indices, self._coordinates):
            if buffer:
                buffer.release()

    def material_uniforms(self, pictures: PictureTextures) -> dict[str, Any]:
        """Uniforms of geometry.frag.glsl; the picture, if the material has one, is bound."""
        material, picture = self.material, self.material.diffuse
        plain = (0.0, 0.0, 0.0) if isinstance(picture, Texture) else tuple(picture.tolist())
        uniforms: dict[str, Any] = {
            "diffuse": (*plain, float(material.two_sided)),
            "specular": (*material.specular.tolist(), material.exponent),
            "mapping": self._mapping,
        }
        if isinstance(picture, Texture):
            uniforms |= pictures.bind(picture, 0, "picture", "picture_bitmap")
        return uniforms


def bounding_box(scene: Scene) -> np.ndarray:
    """Corners of the box around all that can cast a shadow, (8, 3); of an empty one at the origin without meshes."""
    extremes = [f(mesh.vertices, axis=0) for mesh in scene.meshes for f in (np.min, np.max)] or [np.zeros(3)]
    low, high = np.min(extremes, axis=0), np.max(extremes, axis=0)
    return np.array([np.where([i & 1, i & 2, i & 4], high, low) for i in range(8)], np.float64)


class Geometry:
    """All meshes of a scene on the GPU.

    Attributes
    ----------
    bounds : (8, 3)       see `bounding_box`
    is_specular : bool    whether a material has a specular part
    """

    def __init__(self, device: Device, scene: Scene) -> None:
        self.meshes = [MeshBuffers(device.context, mesh) for mesh in scene.meshes]
        self.bounds = bounding_box(scene)
        self.is_specular = any((mesh.material.specular > 0).any() for mesh in scene.meshes)

    def release(self) -> None:
        """Give all buffers back."""
        for mesh in self.meshes:
            mesh.release()
