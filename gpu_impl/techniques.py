"""The registry: every technique is one cell of visibility strategy x airlight model x lattice."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import MISSING, dataclass, fields, replace
from numbers import Integral
from pathlib import Path
from typing import Any

import numpy as np

from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.lattices import LATTICES
from gpu_impl.own_files import OWN
from gpu_impl.visibilities import VISIBILITIES
from scenes.errors import InputError
from scenes.messages import readable
from scenes.model import Light, Scene

# how pixels between evaluated ones get their value: a file under shaders/upsampling and a line
UPSAMPLINGS = {name: f"upsampling/{name}.glsl" for name in ("bilateral", "nearest_depth", "bilinear")}
# what a setting may be, where it is one of a few
CHOICES: dict[str, Collection[object]] = {
    "visibility": VISIBILITIES,
    "airlight": AIRLIGHT_MODELS,
    "lattice": LATTICES,
    "downsample": (1, 2, 4, 8),
    "upsample": UPSAMPLINGS,
    # shadows on surfaces: of a light without extent, or filtered to look soft (percentage-closer filtering)
    "surface_shadows": ("hard", "soft"),
    # where the scattering pass reads the shadow map: a texture, or a storage buffer, as the thesis has a buffer
    "shadow_storage": ("texture", "buffer"),
    # where the visibility learns what lies in the dark: the shadow map, or rays that the reference casts, a control
    "shadow_source": ("map", "rays"),
    # how surface and airlight come together: with fog on both of the surface light's legs, or as Weng 2010, Eq. 14,
    # prints it, without fog between light and surface
    "composition": ("physical", "printed"),
}
# the least and the most of the others
RANGES = {"steps": (1, 1 << 20), "shadow_map": (1, 1 << 14)}
CELL_STEPS = 128
# So near to a light, fog that is all lit as it is at the eye comes out ten times too bright: measured 9.3 at 1 / 40 of
# a mean free path in front of a point light, and as much more as the light is nearer.
CLOSE = 40


@dataclass(frozen=True)
class Technique:
    """One cell of the product, with its settings.

    Attributes
    ----------
    name : str
    visibility, airlight : str    which parts it is made of
    steps : int                   samples of the visibility along a ray
    shadow_map : int              texels on a side of each shadow-map tile
    lattice : str                 which rays fog is evaluated on
    downsample : int              every how many pixels, in x and in y: how coarse a lattice is
    upsample : str                how the grid's values come to all pixels; other lattices have a way of their own
    surface_shadows, shadow_storage, shadow_source, composition : str    see `CHOICES`
    """

    name: str
    visibility: str
    airlight: str
    steps: int = 64
    shadow_map: int = 1024
    lattice: str = "grid"
    downsample: int = 1
    upsample: str = "bilateral"
    surface_shadows: str = "hard"
    shadow_storage: str = "texture"
    shadow_source: str = "map"
    composition: str = "physical"

    def check(self) -> None:
        """Raise InputError where a part is unknown or a setting cannot be used."""
        for setting in ("steps", "shadow_map", "downsample"):
            value = getattr(self, setting)
            # True is an int to Python, and to nobody else
            if isinstance(value, bool) or not isinstance(value, Integral):
                raise InputError(f"{setting} is {value!r}; use a whole number.")
        for setting, (least, most) in RANGES.items():
            if not least <= getattr(self, setting) <= most:
                raise InputError(f"{setting} is {getattr(self, setting)}; use {least} to {most}.")
        for setting, known in CHOICES.items():
            value = getattr(self, setting)
            # asked of a tuple, which takes what cannot be hashed too
            if value not in tuple(known):
                choices = ", ".join(map(str, known))
                if setting == "downsample":
                    raise InputError(f"downsample is {value}; use {choices}.")
                what = "airlight model" if setting == "airlight" else setting.replace("_", " ")
                raise InputError(f"There is no {what} '{readable(str(value))}'; use one of {choices}.")
        if VISIBILITIES[self.visibility].grid_only and self.lattice != "grid":
            raise InputError(
                f"The visibility {self.visibility} draws on the image's pixels, and the lattice {self.lattice} has "
                "others: use lattice grid, or another visibility such as exact."
            )
        if self.shadow_source == "rays" and not VISIBILITIES[self.visibility].asks_points:
            raise InputError(
                f"The visibility {self.visibility} does not ask about points, so that rays cannot answer in place of "
                "the shadow map: leave shadow_source out, or use the visibility given."
            )

    @property
    def with_quadrature(self) -> str:
        """The cell with the airlight model that takes everything, as somebody can ask for it: for messages."""
        # a part of somebody's own is known by its file alone
        return "the airlight model quadrature" if OWN in self.visibility else f"{self.visibility}+quadrature"

    @property
    def asks_rays(self) -> bool:
        """Whether it is told by ray casting what is lit: a control, whose cost means nothing."""
        return VISIBILITIES[self.visibility].given or self.shadow_source == "rays"

    def check_scene(self, scene: Scene) -> None:
        """Raise InputError where the airlight model cannot take the scene's phase function or one of its lights."""
        model = AIRLIGHT_MODELS[self.airlight]
        if model.phases is not None and scene.phase.name not in model.phases:
            raise InputError(
                f"The airlight model {self.airlight} takes the phase function {' or '.join(model.phases)}, and the "
                f"scene has {scene.phase.name}: use {self.with_quadrature}, or set the scene's phase function."
            )
        if model.any_light:
            return
        for light in scene.lights:
            if light.kind == "directional" or not (scene.boundary is None or scene.boundary.contains(light.position)):
                where = "" if light.kind == "directional" else " outside it"
                raise InputError(
                    f"The airlight model {self.airlight} takes point and spot lights inside the medium, and the scene "
                    f"has a {light.kind} light{where}: use {self.with_quadrature}."
                )

    def notices(self, scene: Scene) -> list[str]:
        """What the technique does to a scene that it can draw, and that nobody would expect."""
        model, found = AIRLIGHT_MODELS[self.airlight], []
        soft = any(light.beam_width < light.cutoff_angle or light.texture for light in scene.lights)
        if soft and not model.any_light:
            found.append(
                f"The airlight model {self.airlight} takes a spot's intensity as constant over a lit piece, and the "
                f"scene's changes with the angle: {self.with_quadrature} follows it."
            )
        if model.depth_only and any(_is_close(light, scene) for light in scene.lights):
            found.append(
                f"The airlight model {self.airlight} has all of a ray lit as it is where the ray begins, and the scene "
                f"has a light close by: it may be ten times too bright, or much more. {self.with_quadrature} is not."
            )
        return found


def _is_close(light: Light, scene: Scene) -> bool:
    """Whether a light is nearer to where rays begin than 1 / CLOSE of how far they see."""
    if light.kind == "directional":
        return False
    far = 1 / max(float(np.mean(scene.medium.sigma_t)), 1 / scene.camera.far)
    away = np.linalg.norm(scene.camera.rays()[0] - light.position, axis=-1)
    return bool(np.median(away) < far / CLOSE)


# the settings that a technique may be given, by name
SETTINGS = tuple(field.name for field in fields(Technique) if field.default is not MISSING)


def _variants_of_weng2010() -> Iterator[Technique]:
    """Weng 2010 with each of its airlight models that has a name of its own behind a colon, and called after it."""
    for model in AIRLIGHT_MODELS:
        family, _, variant = model.partition(":")
        if family == "weng2010" and variant:
            visibility = "lit_intervals:printed" if variant == "printed" else "lit_intervals"
            yield Technique(f"Weng2010:{variant}", visibility, model, steps=CELL_STEPS)


TECHNIQUES = {
    technique.name: technique
    for technique in (
        Technique("Nishita1987", "uniform_march", "riemann"),
        # repaired, by the exact forms of all phase functions that have one
        Technique("Weng2010", "lit_intervals", "one_ei", steps=CELL_STEPS),
        *_variants_of_weng2010(),
        Technique("Chen2011", "min_max", "quadrature", lattice="epipolar", downsample=4),
        # the artefact of Weng 2010, Figure 1.1
        Technique("FrontFinal", "front_final", "one_ei", steps=CELL_STEPS),
        Technique("Dobashi2002", "slices", "riemann"),
        Technique("James2003", "shadow_faces", "depth_fog"),
        Technique("Wyman2008", "bounded_march", "sun2005", steps=CELL_STEPS),
    )
}


def find_technique(name: str, **settings: Any) -> Technique:
    """Look a technique up and change those of its settings that are not None.

    Parameters
    ----------
    name : a published technique, any other cell as `visibility+airlight`, such as `lit_intervals+quadrature`, or the
        path of a TOML file that describes one (own_technique.py)
    settings : fields of `Technique`; with another visibility or airlight model it is another cell, and is called so

    Raises
    ------
    InputError
        The name or a setting is not known.
    """
    if name in TECHNIQUES:
        technique = TECHNIQUES[name]
    elif name.endswith(".toml"):
        # which asks this registry whether its parts are known
        from gpu_impl.own_technique import load_technique

        technique = load_technique(Path(name))
    elif "+" in name:
        visibility, model = name.split("+", 1)
        technique = Technique(name, visibility, model, steps=CELL_STEPS)
    else:
        raise InputError(
            f"There is no technique '{name}'; use one of {', '.join(TECHNIQUES)}, a cell of the product such as "
            "lit_intervals+quadrature, or the path of a TOML file."
        )
    changed = replace(technique, **{key: value for key, value in settings.items() if value is not None})
    if (changed.visibility, changed.airlight) != (technique.visibility, technique.airlight):
        changed = replace(changed, name=f"{changed.visibility}+{changed.airlight}")
    changed.check()
    return changed
