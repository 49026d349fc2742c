"""Which triangles meet at which edge of a scene: what a silhouette is found from, whatever the light.

An edge belongs to the silhouette seen from a light unless triangles at it lie strictly on both sides of the plane
through the light and the edge. Behind an edge with triangles on both sides it is dark on both sides of that plane, and
crossing it changes nothing; an edge whose triangles all lie on one side may part light from dark. The test asks each
triangle for its third vertex alone, so it needs neither orientation nor a closed mesh: the rim of a sheet (one
triangle), three and more triangles at an edge and triangles that are wound the wrong way come right.

On a closed manifold with consistent orientation it is the usual test. Its edges have two triangles, whose planes
contain the edge; the light faces one and not the other exactly where both triangles lie on one side of the plane
through light and edge (fold the two along the edge: they are seen side by side, or one behind the other).

Where a third vertex lies in that plane, or as near to it as float32 can tell, it is on neither side, and the edge
counts as silhouette (shaders/shadow_volume/silhouette.comp.glsl). So rounding adds edges and never loses one. An edge
too many has the same light on both sides, which the visibilities allow for; a lost one would tear a shadow open.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from scenes.model import Array, Scene

# of the storage blocks of shaders/shadow_volume/edges.glsl
FIRST_BINDING = 3


def edges_of(vertices: Array, faces: Array) -> tuple[Array, Array]:
    """Edges of a mesh, and for each the vertices that its triangles have opposite to it.

    Parameters
    ----------
    vertices : (V, 3)    none twice
    faces : (F, 3)       a triangle with fewer than three different vertices has no opposite ones, and is left out

    Returns
    -------
    edges : (E, 4) uint32    two vertices; where the edge's opposite vertices begin, and how many there are
    opposite : (n,) uint32   vertices
    """
    faces = faces.astype(np.uint64)
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    start, end, opposite = faces.ravel(), np.roll(faces, -1, axis=1).ravel(), np.roll(faces, -2, axis=1).ravel()
    count = np.uint64(len(vertices))
    key = np.minimum(start, end) * count + np.maximum(start, end)
    order = np.argsort(key)
    key = key[order]
    first = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1]])) if len(key) else np.zeros(0, np.intp)
    triangles = np.diff(np.append(first, len(key)))
    edges = np.column_stack([key[first] // count, key[first] % count, first, triangles])
    return edges.astype(np.uint32), opposite[order].astype(np.uint32)


def welded(scene: Scene) -> tuple[Array, Array]:
    """All meshes of a scene as one, vertices at the same place being one vertex.

    Files give a vertex twice where texture coordinates or normals have a seam, and a flat-shaded face shares none.

    Returns
    -------
    vertices : (V, 3) float32
    faces : (F, 3) integer
    """
    if not scene.meshes:
        return np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int64)
    counts = [len(mesh.vertices) for mesh in scene.meshes]
    begins = np.cumsum([0, *counts[:-1]])
    faces = np.concatenate([mesh.faces.astype(np.int64) + at for mesh, at in zip(scene.meshes, begins, strict=True)])
    # -0 and 0 are one place
    vertices = np.concatenate([mesh.vertices for mesh in scene.meshes]).astype(np.float32) + np.float32(0)
    order = np.lexsort(vertices.T)
    ordered = vertices[order]
    new = np.concatenate([[True], (ordered[1:] != ordered[:-1]).any(axis=1)])
    number = np.empty(len(vertices), np.int64)
    number[order] = np.cumsum(new) - 1
    return ordered[new], number[faces]


class Adjacency:
    """A scene's edges on the GPU, kept from frame to frame: they depend on neither eye nor light.

    Attributes
    ----------
    edge_count : int
    silhouette : buffer   what shaders/shadow_volume/silhouette.comp.glsl gathers of one light, (edge_count, 4) uint32
    draw_call : buffer    how much of it there is, as glDrawArraysIndirect takes it
    bytes : int           of GPU memory
    """

    def __init__(self, context: Any, scene: Scene) -> None:
        vertices, faces = welded(scene)
        edges, opposite = edges_of(vertices, faces)
        self.edge_count = len(edges)
        # a vec4 each
        padded = np.pad(vertices, ((0, 0), (0, 1)))
        # a buffer cannot be empty
        constant = [context.buffer(part.tobytes() or bytes(16)) for part in (padded, edges, opposite)]
        # room for every edge to be in the silhouette
        self.silhouette = context.buffer(reserve=max(16 * self.edge_count, 16))
        self.draw_call = context.buffer(reserve=20)
        self._buffers = (*constant, self.silhouette, self.draw_call)
        self.bytes = sum(buffer.size for buffer in self._buffers)

    def bind(self) -> None:
        """Bind to the storage blocks of shaders/shadow_volume/edges.glsl."""
        for binding, buffer in enumerate(self._buffers, start=FIRST_BINDING):
            buffer.bind_to_storage_buffer(binding)

    def release(self) -> None:
        """Give the buffers back."""
        for buffer in self._buffers:
            buffer.release()
