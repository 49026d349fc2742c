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
from math import ceil
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from experiments.provenance import commit
from reference.agreement.witnesses import EquiangularWitness
from reference.convergence import Estimate, StoppedBy, converge
from reference.estimate import Reference
from reference.goal import FEWEST_IN_LIMIT, Goal
from reference.integrator import mi
from reference.moments import TILE, tiles
from scenes.errors import InputError
from scenes.model import Scene
from scenes.replacing import make_folder, replacing

# raised when an older airlight could not read what this one writes
FORMAT = 1
# a tenth of the least error that is gated, on most pixels
GOAL = Goal(rel_error=0.001, time_limit=120.0)
RENEW = "`airlight gate --update` estimates it anew"
Arrays = dict[str, NDArray[Any]]
_Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class _Record(BaseModel):
    """What stands beside the arrays; `made_by` may too."""

    model_config = ConfigDict(strict=True, frozen=True)

    recipe: dict[str, Any]
    recipe_hash: str
    goal: Goal
    largest_error: _Positive
    passes: Annotated[int, Field(ge=FEWEST_IN_LIMIT)]
    planned_for: _Positive
    rel_error: _Positive
    stopped_by: StoppedBy
    seconds: _Positive


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
    recipe, now = record.recipe, deciding(scene)
    found = {key: recipe.get(key) for key in now}
    if record.recipe_hash != recipe_hash(found):
        raise InputError(f"The committed reference {path} does not have the hash of its own recipe: {RENEW}.")
    if found != now:
        changed = ", ".join(key.replace("_", " ") for key in now if found[key] != now[key])
        meshes = ", with the stand-ins of its meshes, as `airlight gate` draws it," if changed == "scene" else ""
        raise InputError(
            f"The committed reference {path} is stale: its {changed} is not that of the scene {scene.name} as it is "
            f"now{meshes}; where that is meant, {RENEW}."
        )
    if not _is_whole(arrays, scene):
        raise _damaged(path)
    return Reference(_unpacked(arrays, record), recipe, record.goal, from_cache=True)


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


def _damaged(path: Path) -> InputError:
    return InputError(f"The committed reference {path} is damaged: restore it from the repository, or {RENEW}.")


def _read(path: Path) -> tuple[Arrays, _Record]:
    if not path.is_file():
        raise InputError(f"There is no committed reference {path}: restore it from the repository, or {RENEW}.")
    try:
        with np.load(path, allow_pickle=False) as entry:
            # each member of a zip has a checksum, which is held against its bytes as it is read
            arrays = {name: entry[name] for name in entry.files if name != "record"}
            return arrays, _Record.model_validate_json(str(entry["record"]))
    except Exception:
        # what zipfile, zlib, numpy, pydantic and Goal raise on damaged bytes is of many types
        raise _damaged(path) from None


def _is_whole(arrays: Arrays, scene: Scene) -> bool:
    """Whether all arrays are there, and hold what an estimate of this scene can hold."""
    height, width = scene.camera.height, scene.camera.width
    # a surface has no error, for the lights have no extent
    kinds = {
        "scattering": ("f", (3, height, width)),
        "surface": ("f", (3, height, width)),
        "error": ("f", (3, height, width)),
        "tile_error": ("f", (3, ceil(height / TILE), ceil(width / TILE))),
        "image_error": ("f", (3,)),
        "samples": ("u", (height, width)),
    }
    return (
        {name: (array.dtype.kind, array.shape) for name, array in arrays.items()} == kinds
        and all(bool(np.isfinite(array).all() and (array >= 0).all()) for array in arrays.values())
        and bool(arrays["samples"].all() and arrays["scattering"].any())
    )


def _unpacked(arrays: Arrays, record: _Record) -> Estimate:
    def image(name: str) -> NDArray[np.float64]:
        return np.ascontiguousarray(np.moveaxis(arrays[name], 0, -1), np.float64)

    mean = {"scattering": image("scattering"), "surface": image("surface")}

    def with_surface(of_scattering: NDArray[Any]) -> Arrays:
        return {"scattering": of_scattering, "surface": np.zeros_like(of_scattering)}

    return Estimate(
        mean=mean,
        standard_error=with_surface(image("error") * record.largest_error),
        tile_mean={layer: tiles(one) for layer, one in mean.items()},
        tile_error=with_surface(image("tile_error")),
        image_mean={layer: one.mean(axis=(0, 1)) for layer, one in mean.items()},
        image_error=with_surface(arrays["image_error"]),
        samples=arrays["samples"].astype(np.uint32),
        passes=record.passes,
        planned_for=record.planned_for,
        rel_error=record.rel_error,
        stopped_by=record.stopped_by,
        seconds=record.seconds,
    )
