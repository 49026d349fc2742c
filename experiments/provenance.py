"""What made a result: versions, machine, commit."""

from __future__ import annotations

import platform
import subprocess
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    # the doctor asks for versions where the rest may not import
    from gpu_impl.frame import Frame
    from reference.estimate import Reference
    from scenes.model import Scene


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
    """Metadata of a scene: enough to load it again and to see whether it is the same."""
    return {
        "scene": scene.name,
        "scene_digest": scene.digest,
        "parameters": " ".join(f"{name}={value}" for name, value in scene.parameters.items()),
        "size": f"{scene.camera.width} {scene.camera.height}",
        "stand_ins": " ".join(scene.stand_ins),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        **environment(),
    }


def describe_frame(frame: Frame) -> dict[str, str]:
    """Metadata of what drew a frame."""
    technique = frame.technique
    return {
        "technique": technique.name,
        "visibility": technique.visibility,
        "airlight_model": technique.airlight,
        "steps": str(technique.steps),
        "shadow_map": str(technique.shadow_map),
        "downsample": str(technique.downsample),
        "gl_renderer": frame.gl.renderer,
        "gl_version": frame.gl.version,
    }


def describe_reference(reference: Reference) -> dict[str, str]:
    """Metadata of what estimated a reference, its seeds included: pass k of the estimate has seed k."""
    estimate, recipe = reference.estimate, reference.recipe
    return {
        "estimator": f"{recipe['estimator']} {recipe['estimator_version']}",
        "variant": recipe["variant"],
        "pixel_filter": reference.pixel_filter,
        "passes": str(estimate.passes),
        "samples_per_pass": str(recipe["samples_per_pass"]),
        "seeds": f"0 to {estimate.passes - 1}",
        "rel_error": f"{estimate.rel_error:.6g}",
        "rel_error_asked": f"{recipe['goal']['rel_error']:.6g}",
        "rel_error_reached": str(estimate.reached),
    }
