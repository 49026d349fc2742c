"""Figure 2.3: what airlight models make of the same lit pieces, as absolute errors mapped to hue."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic import airlight, phase
from experiments.figures.choices import SUBJECT
from experiments.figures.entry import Drawn
from experiments.figures.panels import error_bar, picture_grid, show, show_error
from experiments.figures.plane import Array
from experiments.figures.stage import Stage
from experiments.heat_maps.heat_map import HeatMap

# the thesis's map, from blue to red; over three decades, since the models are that far apart
HUE = HeatMap(signed=False, unit="radiance", logarithmic=True, colours="hue")
PHASES = {"isotropic": {}, "hg": {"g": 0.6}}
SHOWN = {
    "isotropic": ("sun2005", "pegoraro2009", "weng2010:printed", "weng2010:three-ei"),
    "hg": ("pegoraro2009", "weng2010:printed", "weng2010:minimax", "quadrature_float32"),
}


@dataclass(frozen=True)
class Pieces:
    """The lit pieces of a picture, by ray casting, under the scene's first light.

    Attributes
    ----------
    pixel : (n,)             in row order
    begin, end : (n,)        along the pixel's ray [scene unit]
    x_h, h : (n,)            where the ray passes the light
    """

    pixel: NDArray[np.intp]
    begin: Array
    end: Array
    x_h: Array
    h: Array

    @classmethod
    def of_subject(cls, stage: Stage) -> Pieces:
        """Those of the scene that the diagrams are of."""
        field = stage.field(SUBJECT)
        intervals = field.intervals
        origin = field.scene.camera.rays()[0].reshape(-1, 3)[intervals.pixel]
        to_light = field.scene.lights[0].position - origin
        x_h = field.x_h[intervals.pixel]
        h = np.sqrt((to_light**2).sum(-1) - x_h**2)
        return cls(intervals.pixel, intervals.begin, intervals.end, x_h, h)

    def radiance(self, stage: Stage, model: str, name: str, dtype: type = np.float32) -> Array:
        """What a model makes of each piece, the way from its begin to the eye left out, (n, 3)."""
        scene = stage.field(SUBJECT).scene
        with np.errstate(all="ignore"):
            return airlight(
                self.h,
                self.begin - self.x_h,
                self.end - self.x_h,
                scene.medium,
                phase(name, **PHASES.get(name, {})),
                intensity=scene.lights[0].intensity,
                model=model,
                dtype=dtype,
            )

    def picture(self, stage: Stage, radiance: Array) -> Array:
        """The pieces' light as it reaches the eye, (H, W, 3); what is not finite is infinitely bright."""
        scene = stage.field(SUBJECT).scene
        seen = np.nan_to_num(radiance, nan=np.inf) * np.exp(-scene.medium.sigma_t * self.begin[:, None])
        image = np.zeros((scene.camera.height * scene.camera.width, 3))
        np.add.at(image, self.pixel, seen)
        return image.reshape(scene.camera.height, scene.camera.width, 3)

    def errors(self, stage: Stage, model: str, name: str) -> Array:
        """Relative errors of a model in float32 on each piece, (n,), of the first channel; inf where not finite."""
        truth = self.radiance(stage, "quadrature", name, np.float64)[:, 0]
        with np.errstate(invalid="ignore"):
            return np.nan_to_num(np.abs(self.radiance(stage, model, name)[:, 0] / truth - 1), nan=np.inf)


def models_compared(stage: Stage) -> Drawn:
    """Figure 2.3."""
    pieces = Pieces.of_subject(stage)
    figure, axes = picture_grid(2, 5)
    told = []
    for row, (name, models) in enumerate(SHOWN.items()):
        truth = pieces.picture(stage, pieces.radiance(stage, "quadrature", name, np.float64))
        label = " ".join([name, *map(str, PHASES[name].values())])
        show(axes[row, 0], truth, truth, f"{label}: float64 quadrature")
        for column, model in enumerate(models, start=1):
            image = pieces.picture(stage, pieces.radiance(stage, model, name))
            shown = show_error(axes[row, column], image, truth, model, HUE)
            off = np.percentile(pieces.errors(stage, model, name), [50, 95])
            told.append(f"{label}, `{model}` {off[0]:.1e} and {off[1]:.1e}")
        error_bar(figure, shown, axes[row, -1], HUE)
    return Drawn(
        figure,
        f"Airlight of the {len(pieces.pixel)} lit pieces of `{SUBJECT}` at {stage.field(SUBJECT).scene.camera.width} "
        "pixels, "
        "found by ray casting and the same for all models; models in float32, as shaders compute. Absolute error from "
        "blue to red on a logarithmic scale, white beyond it. Relative errors of pieces, median and 95 %: "
        f"{'; '.join(told)}. Lecocq et al.'s model, which the thesis's figure has too, is not in airlight.",
    )
