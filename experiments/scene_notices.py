"""What of a scene is not as its file has it."""

from __future__ import annotations

from scenes.model import Scene


def scene_notices(scene: Scene) -> list[str]:
    """Which meshes are not the real ones, and what of the file is replaced, in sentences."""
    found = []
    if scene.replaced:
        found.append(
            f"{scene.name}: single scattering is computed, not what its integrator '{scene.replaced[0]}' would be."
        )
    if scene.stand_ins:
        found.append(
            f"{scene.name}: a procedural stand-in serves for {', '.join(scene.stand_ins)}; "
            "set AIRLIGHT_MESH_DIR to a folder with the mesh to use the real one (`airlight meshes list`)."
        )
    return found
