"""The registry: every technique is one cell of visibility strategy x airlight model x lattice."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from numbers import Integral
from typing import Any

from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.visibilities import VISIBILITIES
from scenes.errors import InputError
from scenes.messages import readable
from scenes.model import Scene

DOWNSAMPLES = (1, 2, 4, 8)
# how pixels between evaluated ones get their value; a file under shaders/upsampling and a line
UPSAMPLINGS = {"bilateral": "upsampling/bilateral.glsl"}
# how surface and airlight come together: with fog on both of the surface light's legs, or as Eq. 14 prints it,
# without fog between light and surface
COMPOSITIONS = ("physical", "printed")
MOST_STEPS = 1 << 20
CELL_STEPS = 128


@dataclass(frozen=True)
class Technique:
    """One cell of the product, with its settings.

    Attributes
    ----------
    name : str
    visibility, airlight : str    keys of `VISIBILITIES` and `AIRLIGHT_MODELS`
    steps : int                   samples of the visibility along a ray
    shadow_map : int              texels on a side of each shadow-map tile
    downsample : int              every how many pixels fog is evaluated, in x and in y
    upsample : str                one of `UPSAMPLINGS`
    composition : str             one of `COMPOSITIONS`
    """

    name: str
    visibility: str
    airlight: str
    steps: int = 64
    shadow_map: int = 1024
    downsample: int = 1
    upsample: str = "bilateral"
    composition: str = "physical"

    def check(self) -> None:
        """Raise InputError where a part is unknown or a setting cannot be used."""
        _choose("visibility", self.visibility, VISIBILITIES)
        _choose("airlight model", self.airlight, AIRLIGHT_MODELS)
        _choose("upsampling", self.upsample, UPSAMPLINGS)
        _choose("composition", self.composition, COMPOSITIONS)
        for setting in ("steps", "shadow_map", "downsample"):
            value = getattr(self, setting)
            # True is an int to Python, and to nobody else
            if isinstance(value, bool) or not isinstance(value, Integral):
                raise InputError(f"{setting} is {value!r}; use a whole number.")
        if not 1 <= self.steps <= MOST_STEPS:
            raise InputError(f"steps is {self.steps}; use 1 to {MOST_STEPS}.")
        if not 1 <= self.shadow_map <= 16384:
            raise InputError(f"shadow_map is {self.shadow_map}; use 1 to 16384 texels.")
        if self.downsample not in DOWNSAMPLES:
            raise InputError(f"downsample is {self.downsample}; use {', '.join(map(str, DOWNSAMPLES))}.")

    def check_scene(self, scene: Scene) -> None:
        """Raise InputError where the airlight model cannot take the scene's phase function or one of its lights."""
        model = AIRLIGHT_MODELS[self.airlight]
        if model.phases is not None and scene.phase.name not in model.phases:
            raise InputError(
                f"The airlight model {self.airlight} takes the phase function {' or '.join(model.phases)}, and the "
                f"scene has {scene.phase.name}: use {self.visibility}+quadrature, or set the scene's phase function."
            )
        if model.any_light:
            return
        for light in scene.lights:
            if light.kind == "directional" or not (scene.boundary is None or scene.boundary.contains(light.position)):
                where = "" if light.kind == "directional" else " outside it"
                raise InputError(
                    f"The airlight model {self.airlight} takes point and spot lights inside the medium, and the scene "
                    f"has a {light.kind} light{where}: use {self.visibility}+quadrature."
                )


TECHNIQUES = {
    technique.name: technique
    for technique in (
        Technique("Nishita1987", "uniform_march", "riemann"),
        Technique("Weng2010", "lit_intervals", "weng2010", steps=CELL_STEPS),
    )
}


def find_technique(name: str, **settings: int | None) -> Technique:
    """Look a technique up and change those of its settings that are not None.

    Parameters
    ----------
    name : a published technique, or any other cell as `visibility+airlight`, such as `lit_intervals+quadrature`
    settings : fields of `Technique`

    Raises
    ------
    InputError
        The name or a setting is not known.
    """
    if name in TECHNIQUES:
        technique = TECHNIQUES[name]
    elif "+" in name:
        visibility, model = name.split("+", 1)
        technique = Technique(name, visibility, model, steps=CELL_STEPS)
    else:
        raise InputError(
            f"There is no technique '{name}'; use one of {', '.join(TECHNIQUES)}, or a cell of the product such as "
            "lit_intervals+quadrature."
        )
    changes: dict[str, Any] = {key: value for key, value in settings.items() if value is not None}
    technique = replace(technique, **changes)
    technique.check()
    return technique


def _choose(what: str, name: str, known: Iterable[str]) -> None:
    if name not in known:
        raise InputError(f"There is no {what} '{readable(name)}'; the known ones are {', '.join(known)}.")
