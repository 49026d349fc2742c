"""Where the errors of the scattering layer are: at edges of depth, at edges of light shafts, or on smooth ground.

Upsampling interpolates fog between evaluated pixels and looks at depth to do so, so that it can go wrong in two ways:
where depth is cut, and it takes the wrong neighbours; and where the fog itself is cut by the border of a shadow, of
which depth knows nothing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter

from experiments.measurements import Measurement, Value
from experiments.measurements.shot import Shot
from experiments.metrics import Image, signed_relative_error
from gpu_impl.techniques import CHOICES
from reference.brightness import darkest
from scenes.model import Camera

Mask = NDArray[np.bool_]

# in the order of the columns
REGIONS = ("smooth", "shaft", "edge")
COLUMNS = ("rel_50", "rel_95", "bias", "share")
# The coarsest lattice's spacing, whatever the technique's own is: an evaluated pixel is used for pixels less than this
# away, and the split is the same for all techniques.
REACH = max(int(str(step)) for step in CHOICES["downsample"])
# The bend of a profile at a pixel, |a - 2 b + c| over its size, at which it is taken for cut. Inverse depth is straight
# over any plane, however steep, so that only a jump or a sharp fold bends it by as much; 2 % is where the upsampling
# shaders cease to take depths for alike.
DEPTH_BEND = 0.02
# Of the airlight. In the smooth regions of donut_dragon, wire_mesh and sphere (256 x 256) 99 % of the pixels bend by
# less than 0.38, 0.26 and 0.07 %.
SHAFT_BEND = 0.05
# standard errors of a bend by which the reference's noise exceeds one of its pixels in 15,000
NOISE = 4.0


def regions(shot: Shot) -> dict[str, Value]:
    """Errors of the scattering layer in each region, such as `smooth.rel_50`, `.rel_95`, `.bias`, and its `.share`.

    As in `experiments.metrics`, but over a region's pixels with airlight, in the picture or in the reference; the share
    is of all such pixels. The others are None where a region has none, and all where the reference is black.
    """
    frame, truth, noise = shot.frame, shot.reference.scattering, shot.reference.standard_error("scattering")
    parts = split(frame.depth, shot.scene.camera, truth, noise)
    sampled = shot.reference.noise("scattering")
    return measure_regions(frame.scattering, truth, np.zeros_like(truth) if sampled is None else sampled, parts)


def measure_regions(test: Image, truth: Image, noise: Image, parts: dict[str, Mask]) -> dict[str, Value]:
    """Errors in regions, masks (H, W), by their names; `noise` is the truth's standard error or 0; all (H, W, 3)."""
    test, truth, noise = (np.asarray(image, np.float64) for image in (test, truth, noise))
    fog = (test != 0) | (truth != 0)
    columns: dict[str, Value] = {f"{name}.{column}": None for name in parts for column in COLUMNS}
    if not (truth > 0).any():
        return columns
    relative, squared = np.abs(signed_relative_error(test, truth)), (test - truth) ** 2
    for name, part in parts.items():
        here = fog & part[..., None]
        columns[f"{name}.share"] = float(here.sum() / fog.sum())
        if here.any():
            median, most = np.percentile(relative[here], (50, 95))
            bias = np.sqrt(max(0.0, np.mean(squared[here]) - np.mean(noise[here] ** 2)))
            columns |= {f"{name}.rel_50": float(median), f"{name}.rel_95": float(most), f"{name}.bias": float(bias)}
    return columns


def split(depth: NDArray[np.floating], camera: Camera, truth: Image, noise: Image) -> dict[str, Mask]:
    """Masks (H, W) that hold each pixel once, by the names in `REGIONS`.

    Parameters
    ----------
    depth : (H, W)              distance along the pixel's ray from the near plane [scene unit]
    truth, noise : (H, W, 3)    the reference's airlight and its standard error
    """
    edge = reached(depth_edges(depth, camera))
    shaft = reached(shaft_edges(truth, noise)) & ~edge
    return dict(zip(REGIONS, (~edge & ~shaft, shaft, edge), strict=True))


def depth_edges(depth: NDArray[np.floating], camera: Camera) -> Mask:
    """Pixels at which inverse depth bends by more than `DEPTH_BEND`, (H, W): both sides of a silhouette.

    Inverse depth along the viewing axis is a linear function of the pixel over any plane, the far one included.
    """
    # both grow alike along a ray: their ratio is that of depths along the axis
    along_axis = camera.near + (camera.far - camera.near) * depth / camera.rays()[2]
    inverse = 1 / along_axis
    return _bent(inverse[..., None], DEPTH_BEND * inverse[..., None])


def shaft_edges(airlight: Image, noise: Image) -> Mask:
    """Pixels at which the reference's airlight bends by more than `SHAFT_BEND`, and by more than its noise may, (H, W).

    The share is of the airlight there or of the darkest that counts (`reference.brightness`), whichever is more.
    """
    airlight = np.asarray(airlight, np.float64)
    bright = np.maximum(airlight, darkest(airlight))
    # the variances of a, 2 b and c add up to 6 of one pixel's
    return _bent(airlight, SHAFT_BEND * bright + NOISE * np.sqrt(6) * np.asarray(noise))


def reached(cut: Mask) -> Mask:
    """Pixels that are `REACH` or less away from a cut, in x and in y."""
    return maximum_filter(cut, size=2 * REACH + 1, mode="constant", cval=False)


def _bent(values: NDArray[np.floating], limit: NDArray[np.floating]) -> Mask:
    """Where the second difference in x or in y exceeds a limit in any channel; both (H, W, channels).

    An image's outermost pixels have no second difference across its border; a cut beside one is its neighbour's.
    """
    found = np.zeros(values.shape, bool)
    for axis in (0, 1):
        inner = (slice(1, -1), slice(None)) if axis == 0 else (slice(None), slice(1, -1))
        found[inner] |= np.abs(np.diff(values, n=2, axis=axis)) > limit[inner]
    return np.any(found, axis=-1)


MEASUREMENT = Measurement(regions)
