"""Why a layer of a reference is infinite or not a number somewhere, from the scene's numbers."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from scenes.model import Array, Scene

# of the distance from the camera: so near to a light float32 takes a ray to go through it
THROUGH = 1e-6
# the square of more is infinite in float32
LARGEST = float(np.sqrt(np.finfo(np.float32).max))


def why_not_finite(scene: Scene, layer: str, image: Array) -> str:
    """Say in a sentence where a layer is not finite, and why.

    Parameters
    ----------
    layer : str
    image : (H, W, 3)    somewhere infinite or NaN
    """
    bad = np.logical_not(np.isfinite(image).all(axis=-1))
    row, column = np.argwhere(bad)[0]
    pixels = "pixel is" if bad.sum() == 1 else "pixels are"
    return (
        f"The reference of {scene.path} is of no use: in its layer '{layer}' {bad.sum()} of {bad.size} {pixels} not "
        f"finite, the first in column {column} of row {row}: {_reason(scene, bad)}."
    )


def _reason(scene: Scene, bad: NDArray[np.bool_]) -> str:
    for what, value in _lengths_and_strengths(scene):
        if value > LARGEST:
            return f"{what} is {value:.3g}, and float32 holds no square of more than {LARGEST:.2g}; change the unit"
    origin, direction, _ = scene.camera.rays()
    for light in scene.lights:
        if light.kind == "directional":
            continue
        to_light = light.position - origin[bad]
        beside = np.linalg.norm(np.cross(to_light, direction[bad]), axis=-1)
        if (beside <= THROUGH * np.linalg.norm(light.position - scene.camera.origin)).all():
            return (
                f"the camera looks straight into the light at {np.round(light.position, 6).tolist()}, towards which "
                "airlight grows without bound; move one of them a little, or change the size of the image"
            )
    return "no reason was found in the scene; please report this with the scene"


def _lengths_and_strengths(scene: Scene) -> Iterator[tuple[str, float]]:
    """What float32 multiplies with itself or with each other, by what a person knows it as."""
    yield "the distance of the camera from the origin", float(np.linalg.norm(scene.camera.origin))
    yield "sigma_t", float(scene.medium.sigma_t.max())
    for light in scene.lights:
        yield "a light's intensity", float(light.intensity.max())
