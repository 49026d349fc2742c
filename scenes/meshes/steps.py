"""The recorded steps that make a mesh of a scene out of the original that its makers published."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import Any

from scenes.errors import InputError
from scenes.meshes.catmull_clark import catmull_clark
from scenes.meshes.polygons import Polygons, cut_into_triangles, of_triangles
from scenes.meshes.repair import repair, weld


@dataclass(frozen=True)
class Step:
    """One step: the name of a function of STEPS, and its parameters."""

    name: str
    parameters: dict[str, int] = field(default_factory=dict)

    def __str__(self) -> str:
        return f"{self.name}({', '.join(f'{name}={value}' for name, value in self.parameters.items())})"


def decimate(mesh: Polygons, target: int) -> Polygons:
    """The mesh with about `target` triangles, those of least quadric error; it may have to be repaired afterwards.

    Vertices at one place are made one first: a seam would open when its two sides are decimated apart.

    Raises
    ------
    InputError   the mesh has fewer triangles than that

    Source: Garland and Heckbert 1997, "Surface simplification using quadric error metrics", as the library
    fast-simplification has it: in one thread, the same result for the same bytes.
    """
    import fast_simplification

    positions, faces = weld(*cut_into_triangles(mesh))
    if target >= len(faces):
        raise InputError(f"A mesh of {len(faces)} triangles cannot be decimated to {target}; correct the step.")
    return of_triangles(*fast_simplification.simplify(positions, faces, target_count=target))


# each function, and the distributions whose versions decide what comes out
STEPS: dict[str, tuple[Callable[..., Polygons], tuple[str, ...]]] = {
    "catmull_clark": (catmull_clark, ("airlight", "numpy")),
    "decimate": (decimate, ("airlight", "fast-simplification")),
    "repair": (repair, ("airlight", "numpy")),
}


def run_steps(
    mesh: Polygons, steps: Sequence[Step], announce: Callable[[Step], None]
) -> tuple[Polygons, list[dict[str, Any]]]:
    """The mesh after all steps, and the record of each: its parameters, what did it, and what came out.

    Parameters
    ----------
    announce : called with each step before it begins
    """
    records: list[dict[str, Any]] = []
    for step in steps:
        announce(step)
        function, packages = STEPS[step.name]
        mesh = function(mesh, **step.parameters)
        records.append(
            {
                "step": step.name,
                "parameters": step.parameters,
                "made_by": {package: version(package) for package in packages},
                "vertices": len(mesh.vertices),
                "polygons": len(mesh.sides),
            }
        )
    return mesh, records
