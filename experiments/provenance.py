"""What made a result: scene, technique, versions, machine, commit."""

from __future__ import annotations

import json
import platform
import subprocess
from dataclasses import fields
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    # the doctor asks for versions where the rest may not import
    from gpu_impl.frame import Frame
    from gpu_impl.techniques import Technique
    from reference.estimate import Reference
    from scenes.model import Scene

# fields that a technique of somebody's own alone has
OWN_FIELDS = ("file", "texts")
# keys of the technique's fields, where "airlight" is the program's version
TECHNIQUE_KEYS = {
    "name": "technique",
    "airlight": "airlight_model",
    "file": "technique_file",
    "texts": "technique_texts",
}


@cache
def commit() -> str:
    """Git's name for the code that runs, with "-dirty" where it was changed; "unknown" outside a checkout."""
    command = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        return subprocess.run(command, capture_output=True, text=True, timeout=10, check=True).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return "unknown"


def package_version(name: str) -> str:
    """Version of an installed package, or "missing"."""
    try:
        return version(name)
    except PackageNotFoundError:
        return "missing"


@cache
def environment() -> dict[str, str]:
    """Versions and machine, as text."""
    return {
        "airlight": package_version("airlight"),
        "commit": commit(),
        "python": platform.python_version(),
        "mitsuba": package_version("mitsuba"),
        "drjit": package_version("drjit"),
        "numpy": package_version("numpy"),
        "machine": f"{platform.system()} {platform.machine()}",
    }


def describe_scene(scene: Scene) -> dict[str, str]:
    """What a row of results says of its scene; the parameters as a JSON object, whatever signs their values hold."""
    from scenes.manifest import frozen_version

    return {
        "scene": scene.name,
        "scene_version": frozen_version(scene),
        "scene_digest": scene.digest,
        "parameters": json.dumps(scene.parameters),
        "size": f"{scene.camera.width} {scene.camera.height}",
        "stand_ins": " ".join(scene.stand_ins),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        **environment(),
    }


def describe_files(scene: Scene) -> dict[str, str]:
    """Which files a scene was made from; in an EXR only, for a table is read on other machines.

    A shipped scene is called by its name, any other by its absolute path; meshes and pictures are "name:sha256", a JSON
    list. Credits are those that the meshes' terms ask for.
    """
    from scenes.meshes.catalogue import credit

    credits = {credit(mesh.file) for mesh in scene.meshes if mesh.file}
    return {
        "scene_file": scene_file(scene),
        "files": json.dumps(sorted(file_hashes(scene))),
        "credits": "; ".join(sorted(filter(None, credits))),
    }


def scene_file(scene: Scene) -> str:
    """Name of a shipped scene, absolute path of any other."""
    from scenes.catalogue import FOLDER

    path = scene.path.absolute()
    return path.stem if path.parent == FOLDER else str(path)


def file_hashes(scene: Scene) -> dict[str, Path]:
    """Mesh and picture files that a scene is made from: "name:sha256" to where each was found."""
    from scenes.meshes.files import sha256

    paths = [Path(node.props["filename"]) for node in scene.parsed.nodes if "filename" in node.props]
    return {f"{path.name}:{sha256(path)}": path for path in paths}


def describe_technique(technique: Technique) -> dict[str, Any]:
    """A technique's fields, each of them that any technique has, as tables and metadata call them."""
    names = [field.name for field in fields(technique) if field.name not in OWN_FIELDS]
    return {TECHNIQUE_KEYS.get(name, name): getattr(technique, name) for name in names}


def describe_own_files(technique: Technique) -> dict[str, str]:
    """Path and texts of the files of a technique of somebody's own, nothing of any other; in an EXR only.

    A table is read on other machines, and would hold them once a row.
    """
    return {TECHNIQUE_KEYS[name]: getattr(technique, name) for name in OWN_FIELDS if hasattr(technique, name)}


def describe_frame(frame: Frame) -> dict[str, str]:
    """Metadata of what drew a frame: the technique's fields and OpenGL's strings."""
    settings = {key: str(value) for key, value in describe_technique(frame.technique).items()}
    return {**settings, "gl_renderer": frame.gl.renderer, "gl_version": frame.gl.version}


def describe_reference(reference: Reference) -> dict[str, str]:
    """Metadata of what estimated a reference, its seeds included.

    Pass k has seed k, or over a box seeds 2 k and 2 k + 1. The samples of a pass are a mean: each pixel takes those
    that the plan for `planned_for` gives it.
    """
    estimate, recipe = reference.estimate, reference.recipe
    seeds = estimate.passes * (2 if reference.pixel_filter == "box" else 1)
    return {
        "estimator": f"{recipe['estimator']} {recipe['estimator_version']}",
        "variant": recipe["variant"],
        "pixel_filter": reference.pixel_filter,
        "passes": str(estimate.passes),
        "samples_per_pass": f"{float(estimate.samples.mean()):.6g}",
        "planned_for": f"{estimate.planned_for:.6g}",
        "seeds": f"0 to {seeds - 1}" if seeds else "none",
        "rel_error": f"{estimate.rel_error:.6g}",
        "rel_error_percentile": f"{reference.goal.percentile:.6g}",
        "rel_error_asked": f"{reference.goal.rel_error:.6g}",
        "rel_error_reached": str(estimate.reached),
        "stopped_by": estimate.stopped_by,
    }
