"""Which of a scene's triangles cast shadow volumes, and which edges the volumes' faces stand on.

Every triangle that casts has a volume: all that lies behind it, seen from the light. The volumes of neighbours share
the face behind their common edge, one on either side of it, and need none there; so an edge's face counts as often as
the triangles at it do not cancel, +1 or -1 for each by the way in which it runs along the edge, seen from the light.

A body is to count once, not once for its lit side and once for its dark one. Where a part of a mesh is closed, each
edge run along as often in either direction, the triangles that face the light cast and no others; from a light inside
those that look away from it (shaders/shadow_faces/faces.comp.glsl). Any other part is a sheet, of which every triangle
casts. A body that folds back behind itself, and a sheet with a curl, count as often as the light meets them.
"""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from gpu_impl.device import Device
from gpu_impl.light_uniforms import light_defines, light_uniforms
from gpu_impl.passes.shadow_volume import GROUP, MOST_GROUPS
from gpu_impl.shader_source import set_uniforms
from gpu_impl.silhouettes import welded
from gpu_impl.textures import PictureTextures
from scenes.model import Array, Light, Scene

# bytes of the structures Part, Face and Draw of shaders/shadow_faces/buffers.glsl
PART, FACE, DRAW = 12, 48, 20
# invocations of a work group of faces.comp.glsl, whose faces are one draw call
DRAWN_GROUP = 512


def parts_of(vertices: int, faces: Array, mesh: Array) -> Array:
    """Tell the closed parts of meshes from each other and from what is not closed.

    Parameters
    ----------
    vertices : int        how many there are
    faces : (F, 3)        each with three different vertices
    mesh : (F,)           which mesh each belongs to: two that touch are two

    Returns
    -------
    (F,) integer
        0 for triangles of a part that is not closed, 1, 2 ... for those of the closed ones.
    """
    faces = faces.astype(np.int64)
    # a vertex of two meshes is two
    used, number_of = np.unique(faces + vertices * mesh[:, None], return_inverse=True)
    count, corner = len(used), number_of.reshape(-1, 3)
    start, end = corner.ravel(), np.roll(corner, -1, axis=1).ravel()
    graph = coo_array((np.ones(len(start), np.int8), (start, end)), shape=(count, count))
    number, part_of = connected_components(graph, directed=False)
    # how often more an edge is run along upwards than downwards
    edge, place = np.unique(np.minimum(start, end) * count + np.maximum(start, end), return_inverse=True)
    balance = np.bincount(place.ravel(), np.where(start < end, 1, -1), minlength=len(edge))
    is_open = np.zeros(number, bool)
    is_open[part_of[edge[balance != 0] // max(count, 1)]] = True
    return np.where(is_open, 0, np.cumsum(~is_open))[part_of[corner[:, 0]]]


def sides_of(vertices: int, faces: Array) -> tuple[Array, Array]:
    """Edges, and which triangles run along each, in which direction.

    Parameters
    ----------
    vertices : int    how many there are
    faces : (F, 3)    each with three different vertices

    Returns
    -------
    edges : (E, 4) uint32       two vertices, the smaller first; where the edge's sides begin, and how many there are
    sides : (3 F,) uint32       twice the triangle's number, and 1 more where it runs from second vertex to first
    """
    start = faces.astype(np.int64).ravel()
    end = np.roll(faces.astype(np.int64), -1, axis=1).ravel()
    key = np.minimum(start, end) * vertices + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    edge, first, count = np.unique(key[order], return_index=True, return_counts=True)
    side = 2 * np.repeat(np.arange(len(faces)), 3) + (start > end)
    edges = np.column_stack([edge // max(vertices, 1), edge % max(vertices, 1), first, count])
    return edges.astype(np.uint32), side[order].astype(np.uint32)


class ShadowCasters:
    """A scene's triangles and edges on the GPU, kept from frame to frame, and the faces of one light's volumes.

    Attributes
    ----------
    faces : buffer         of the volumes that were found last; see shaders/shadow_faces/buffers.glsl
    draw_calls : buffer    of all of the picture, once, and of the faces, as glMultiDrawArraysIndirect takes them; and
                           how many volumes hold the eye
    draws : int            how many calls
    """

    def __init__(self, context: Any, scene: Scene) -> None:
        vertices, faces = welded(scene)
        mesh = np.repeat(np.arange(len(scene.meshes)), [len(one.faces) for one in scene.meshes])
        whole = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
        faces, mesh = faces[whole], mesh[whole]
        parts = parts_of(len(vertices), faces, mesh)
        edges, sides = sides_of(len(vertices), faces)
        self._triangles, self._edges, self._parts = len(faces), len(edges), int(parts.max(initial=0)) + 1
        triangles = np.column_stack([faces, parts]).astype(np.uint32)
        # a vec4 each
        padded = np.pad(vertices, ((0, 0), (0, 1)))
        # a buffer cannot be empty
        constant = [context.buffer(part.tobytes() or bytes(16)) for part in (padded, triangles, edges, sides)]
        facing = context.buffer(reserve=max(4 * self._triangles, 4))
        self._counts = context.buffer(reserve=PART * self._parts)
        self.faces = context.buffer(reserve=max(FACE * (self._edges + self._triangles), FACE))
        self.draws = 1 + -(-(self._edges + self._triangles) // DRAWN_GROUP)
        self.draw_calls = context.buffer(reserve=DRAW * self.draws)
        self._buffers = (*constant, facing, self._counts, self.faces, self.draw_calls)

    def find_faces(self, device: Device, scene: Scene, light: Light, pictures: PictureTextures) -> None:
        """Find the faces of a light's shadow volumes, and how many of the volumes hold the scene's eye."""
        for binding, buffer in enumerate(self._buffers):
            buffer.bind_to_storage_buffer(binding)
        self._counts.write(bytes(PART * self._parts))
        # three corners for all of the picture, once; no volumes
        # three corners for all of the picture, once; no volumes
        self.draw_calls.write(struct.pack("4Ii", 3, 1, 0, 0, 0))
        camera = scene.camera
        defines = light_defines(scene, light)
        uniforms = light_uniforms(scene, light, pictures) | {
            "eye": tuple(camera.origin),
            "viewing_axis": tuple(camera.to_world[:3, 2]),
            "near": camera.near,
            "triangle_count": self._triangles,
            "edge_count": self._edges,
            "part_count": self._parts,
        }
        numbers = max(self._edges + self._triangles, self._parts)
        for name, count, group in (("triangles", self._triangles, GROUP), ("faces", numbers, DRAWN_GROUP)):
            program = device.compute(f"shadow_faces/{name}.comp.glsl", defines | {"GROUP": group})
            set_uniforms(program, uniforms)
            groups = max(-(-count // group), 1)
            program.run(min(groups, MOST_GROUPS), -(-groups // MOST_GROUPS))
            device.context.memory_barrier()

    def release(self) -> None:
        """Give the buffers back."""
        for buffer in self._buffers:
            buffer.release()
