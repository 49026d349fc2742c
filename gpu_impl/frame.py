"""What a technique draws."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gpu_impl.context import GLInfo
from gpu_impl.techniques import Technique


@dataclass(frozen=True)
class Frame:
    """One picture, split as Weng 2010, Eq. 14 splits it; float32, row 0 at the top, linear Rec.709.

    Attributes
    ----------
    surface : (H, W, 3)        light from surfaces, attenuated on both legs
    scattering : (H, W, 3)     airlight L_m
    depth : (H, W)             distance along the pixel's ray to the surface, or to the far plane [scene unit]
    lit_intervals : (H, W)     pieces that the visibility strategy reported
    technique : Technique
    gl : GLInfo
    scene_digest : str         which scene it is a picture of; see `scenes.model.Scene`
    """

    surface: np.ndarray
    scattering: np.ndarray
    depth: np.ndarray
    lit_intervals: np.ndarray
    technique: Technique
    gl: GLInfo
    scene_digest: str

    @property
    def composite(self) -> np.ndarray:
        """Surface and scattering together, (H, W, 3)."""
        return self.surface + self.scattering

    @property
    def layers(self) -> dict[str, np.ndarray]:
        """Every array by the name that its layer has in an EXR file."""
        names = ("composite", "scattering", "surface", "depth", "lit_intervals")
        return {name: getattr(self, name) for name in names}

    def __repr__(self) -> str:
        """One line, for notebooks."""
        height, width = self.depth.shape
        return f"<Frame {self.technique.name}, {width} x {height}, drawn on {self.gl.renderer}>"
