"""References that are committed with the code: means, errors, and the recipe that decides them, in a small npz.

What makes one stale is what would make it another number: the scene (its digest covers the file, its parameters and
the bytes of its meshes), the size, the estimator with its version, and the pixel filter. Mitsuba's version and variant
stand in the record and do not decide: a machine without LLVM holds techniques against the same truth, and that today's
Mitsuba still gives it is not assumed but estimated (`agreement`).
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.provenance import commit
from reference.agreement.witnesses import EquiangularWitness
from reference.convergence import Estimate, converge
from reference.estimate import Reference
from reference.goal import Goal
from reference.integrator import mi
from reference.moments import tiles
from scenes.errors import InputError
from scenes.model import Scene
from scenes.replacing import make_folder, replacing

# raised when an older airlight could not read what this one writes
FORMAT = 1
# a tenth of the least error that is gated, on most pixels
GOAL = Goal(rel_error=0.001, time_limit=120.0)
RENEW = "`airlight gate --update` estimates it anew"
# in the order of their layers; a surface has no error, for the lights have no extent
_ARRAYS = ("scattering", "surface", "error", "tile_error", "image_error", "samples")


def deciding(scene: Scene) -> dict[str, Any]:
    """All of the recipe that decides the numbers; see above for what does not."""
    return {
        "format": FORMAT,
        "scene": scene.digest,
        "size": [scene.camera.width, scene.camera.height],
        "estimator": EquiangularWitness.name,
        "estimator_version": EquiangularWitness.version,
        "pixel_filter": "centre",
    }


def recipe_hash(recipe: dict[str, Any]) -> str:
    """Hexadecimal SHA-256 of a recipe."""
    return hashlib.sha256(json.dumps(recipe, sort_keys=True).encode()).hexdigest()


def reference_path(folder: Path, scene: Scene) -> Path:
    """Where a scene's reference is: called after the scene, its parameters and its size."""
    parameters = "".join(f"-{value}" for _, value in sorted(scene.parameters.items(), reverse=True))
    return folder / f"{scene.name}{parameters}-{scene.camera.width}x{scene.camera.height}.npz"


def load_reference(folder: Path, scene: Scene) -> Reference:
    """Read a scene's committed reference.

    Raises
    ------
    InputError
        It is missing, damaged or stale; one sentence says which, and how to renew it.
    """
    path = reference_path(folder, scene)
    arrays, record = _read(path)
    recipe, now = record["recipe"], deciding(scene)
    found = {key: recipe.get(key) for key in now}
    if record["recipe_hash"] != recipe_hash(found):
        raise InputError(f"The committed reference {path} does not have the hash of its own recipe: {RENEW}.")
    if found != now:
        changed = ", ".join(key.replace("_", " ") for key in now if found[key] != now[key])
        meshes = ", with the stand-ins of its meshes, as `airlight gate` draws it," if changed == "scene" else ""
        raise InputError(
            f"The committed reference {path} is stale: its {changed} is not that of the scene {scene.name} as it is "
            f"now{meshes}; where that is meant, {RENEW}."
        )
    return Reference(_unpacked(path, arrays, record, scene), recipe, Goal(**record["goal"]), from_cache=True)


def make_reference(scene: Scene) -> Estimate:
    """Estimate a reference that is fit to be committed: little can have been missed between its samples.

    Raises
    ------
    InputError
        Without a usable LLVM: what serves there averages over pixels, and techniques are drawn at their centres.
    """
    if mi.variant() == "scalar_rgb":
        raise InputError(
            "A committed reference is estimated in an LLVM or CUDA variant of Mitsuba, and this machine has "
            "scalar_rgb: `airlight doctor` says what is missing."
        )
    return converge(EquiangularWitness(scene), GOAL)


def write_reference(folder: Path, scene: Scene, estimate: Estimate) -> Path:
    """Write a scene's reference into a folder, whole or not at all, and return its path.

    Means are float32; errors float16 in units of the largest, off by 0.05 % and by 3e-8 of the largest at most.
    """
    recipe = deciding(scene)
    told = {"variant": mi.variant(), "mitsuba": version("mitsuba"), "drjit": version("drjit"), "commit": commit()}
    record = {
        "recipe": recipe | told,
        "recipe_hash": recipe_hash(recipe),
        "goal": asdict(GOAL),
        "made_by": "airlight gate --update",
        **{key: getattr(estimate, key) for key in ("passes", "planned_for", "rel_error", "stopped_by", "seconds")},
    }
    error = estimate.standard_error["scattering"]
    record["largest_error"] = largest = float(error.max())
    arrays: dict[str, Any] = {
        # channel by channel: in grey fog they are alike, and take no more room than one
        "scattering": _planar(estimate.mean["scattering"], np.float32),
        "surface": _planar(estimate.mean["surface"], np.float32),
        "error": _planar(error / largest, np.float16),
        "tile_error": _planar(estimate.tile_error["scattering"], np.float32),
        "image_error": estimate.image_error["scattering"],
        "samples": estimate.samples.astype(np.uint16),
    }
    make_folder(folder, "make it writable")
    path = reference_path(folder, scene)
    with replacing(path) as beside:
        np.savez_compressed(beside, record=np.array(json.dumps(record)), **arrays)
    return path


def _planar(image: NDArray[Any], dtype: type) -> NDArray[Any]:
    return np.ascontiguousarray(np.moveaxis(image, -1, 0), dtype)


def _read(path: Path) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    if not path.is_file():
        raise InputError(f"There is no committed reference {path}: restore it from the repository, or {RENEW}.")
    try:
        with np.load(path, allow_pickle=False) as entry:
            # each member of a zip has a checksum, which is held against its bytes as it is read
            arrays = {name: entry[name] for name in _ARRAYS}
            record = json.loads(str(entry["record"]))
            recipe = record["recipe"]
        if not isinstance(recipe, dict) or "recipe_hash" not in record:
            raise TypeError
    except Exception:
        # what zipfile, zlib, numpy and json raise on damaged bytes is of many types
        raise InputError(
            f"The committed reference {path} is damaged: restore it from the repository, or {RENEW}."
        ) from None
    return arrays, record


def _unpacked(path: Path, arrays: dict[str, NDArray[Any]], record: dict[str, Any], scene: Scene) -> Estimate:
    def image(name: str) -> NDArray[np.float64]:
        return np.ascontiguousarray(np.moveaxis(arrays[name], 0, -1), np.float64)

    mean = {"scattering": image("scattering"), "surface": image("surface")}
    error = image("error") * record["largest_error"]
    shape = (scene.camera.height, scene.camera.width, 3)
    if any(one.shape != shape or not np.isfinite(one).all() for one in (*mean.values(), error)):
        raise InputError(f"The committed reference {path} holds no pictures of {shape[1]} x {shape[0]}: {RENEW}.")

    def with_surface(of_scattering: NDArray[Any]) -> dict[str, NDArray[Any]]:
        return {"scattering": of_scattering, "surface": np.zeros_like(of_scattering)}

    return Estimate(
        mean=mean,
        standard_error=with_surface(error),
        tile_mean={layer: tiles(one) for layer, one in mean.items()},
        tile_error=with_surface(image("tile_error")),
        image_mean={layer: one.mean(axis=(0, 1)) for layer, one in mean.items()},
        image_error=with_surface(arrays["image_error"]),
        samples=arrays["samples"].astype(np.uint32),
        **{key: record[key] for key in ("passes", "planned_for", "rel_error", "stopped_by", "seconds")},
    )
