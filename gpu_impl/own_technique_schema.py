"""What the TOML file of a technique of somebody's own may hold."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import partial
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag

from analytic.phase import PHASES
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.lattices import LATTICES
from gpu_impl.own_files import OWN
from gpu_impl.techniques import SETTINGS, TECHNIQUES
from gpu_impl.visibilities import VISIBILITIES
from scenes.media import PHASES as PLUGINS

# the ending by which a text is a file and not a name
ENDING = ".glsl"


def _known(known: Mapping[str, object], name: str) -> str:
    # the parts of other files are none of ours
    names = [one for one in known if OWN not in one]
    if name not in names:
        raise ValueError(f"there is no '{name}'; use one of {', '.join(names)}")
    return name


def _phase(name: str) -> str:
    # scenes call some by the name of Mitsuba's plugin
    return PLUGINS[name][0] if name in PLUGINS else _known(PHASES, name)


def _is_free(name: str) -> str:
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9 ._:-]{0,59}", name):
        raise ValueError(
            "use 1 to 60 letters, digits, spaces, points, colons, hyphens and underscores, a letter or a digit first"
        )
    if name in TECHNIQUES:
        raise ValueError(f"airlight has a technique {name}; call yours otherwise")
    return name


def _are_settings(settings: dict[str, Any]) -> dict[str, Any]:
    own = [name for name in SETTINGS if name != "lattice"]
    for name in settings:
        if name not in own:
            raise ValueError(f"there is no setting '{name}'; use {', '.join(own)}")
    return settings


VisibilityName = Annotated[str, AfterValidator(partial(_known, VISIBILITIES))]
AirlightName = Annotated[str, AfterValidator(partial(_known, AIRLIGHT_MODELS))]
LatticeName = Annotated[str, AfterValidator(partial(_known, LATTICES))]
PhaseName = Annotated[str, AfterValidator(_phase)]
YesOrNo = Annotated[bool, Field(strict=True)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Part(_Strict):
    """A GLSL file, and what stands beside it.

    Attributes
    ----------
    file : str    from the TOML file's folder
    what : str    in a few words
    """

    file: str
    what: str = "of somebody's own"


class VisibilityPart(Part):
    """A visibility strategy.

    Attributes
    ----------
    supply : str               a registered one: what it is given, this one is given too, such as shadow polygons
                               (lit_intervals) or the pyramid over the shadow map (exact)
    reads_shadow_map : bool    whether the map's resolution is part of its error; left out, as with `supply`, or yes
    asks_points : bool         whether it asks in_shadow() about points on the ray and nothing else what is dark, so
                               that a control can answer in place of the shadow map; left out, as with `supply`, or yes
    """

    supply: VisibilityName | None = None
    reads_shadow_map: YesOrNo | None = None
    asks_points: YesOrNo | None = None


class AirlightPart(Part):
    """An airlight model.

    Attributes
    ----------
    supply : str       a registered one: its computed includes and its table are there for this one too
    phases : list      names of the phase functions that it takes; left out, those of `supply`, or all
    any_light : bool   whether it takes directional lights, and lights outside a bounded medium; left out, as with
                       `supply`, or yes
    point_samples : bool    whether it samples points of a piece, so that it is as accurate as its pieces are short;
                            left out, as with `supply`, or no
    """

    supply: AirlightName | None = None
    phases: Annotated[list[PhaseName], Field(min_length=1)] | None = None
    any_light: YesOrNo | None = None
    point_samples: YesOrNo | None = None


class LatticePart(Part):
    """A lattice.

    Attributes
    ----------
    reconstruction : str    GLSL file of the way back to the image's pixels
    supply : str            a registered one, whose size and uniforms this one has; that of grid by default
    """

    reconstruction: str
    supply: LatticeName = "grid"


def _as_file(part: Any) -> Any:
    if not isinstance(part, str | dict):
        raise ValueError('give the name of a registered part, or one file of GLSL as "mine.glsl" or { file = ... }')
    return {"file": part} if isinstance(part, str) and part.endswith(ENDING) else part


# what pydantic calls the two forms that a part may have, in the places of its errors
NAMED, OF_A_FILE = "named", "of a file"


def _form(part: Any) -> str:
    return NAMED if isinstance(part, str) else OF_A_FILE


Form = Discriminator(_form)


class Described(_Strict):
    """The whole file: each part by a registered name, by a file, or by a table that says more about the file."""

    name: Annotated[str, AfterValidator(_is_free)]
    visibility: Annotated[
        Annotated[VisibilityName, Tag(NAMED)] | Annotated[VisibilityPart, Tag(OF_A_FILE)],
        Form,
        BeforeValidator(_as_file),
    ]
    airlight: Annotated[
        Annotated[AirlightName, Tag(NAMED)] | Annotated[AirlightPart, Tag(OF_A_FILE)], Form, BeforeValidator(_as_file)
    ]
    lattice: Annotated[
        Annotated[LatticeName, Tag(NAMED)] | Annotated[LatticePart, Tag(OF_A_FILE)], Form, BeforeValidator(_as_file)
    ] = "grid"
    settings: Annotated[dict[str, Any], AfterValidator(_are_settings)] = {}
