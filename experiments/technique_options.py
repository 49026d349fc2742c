"""Options for a technique's parts and settings; which values they take is the registry's to say (`airlight list`)."""

from __future__ import annotations

from typing import Annotated

import typer

Visibility = Annotated[str | None, typer.Option(metavar="V", help="Another visibility strategy (`airlight list`).")]
AirlightModel = Annotated[
    str | None, typer.Option("--airlight", metavar="A", help="Another airlight model (`airlight list`).")
]
Steps = Annotated[int | None, typer.Option(metavar="S", help="Samples of the visibility along a ray.")]
ShadowMapSize = Annotated[
    int | None, typer.Option("--shadow-map", metavar="R", help="Texels on a side of the shadow map.")
]
Downsample = Annotated[
    int | None, typer.Option(metavar="N", help="Evaluate fog on every N-th pixel (`airlight list`).")
]
Upsample = Annotated[str | None, typer.Option(metavar="U", help="What fills the pixels between (`airlight list`).")]
SurfaceShadows = Annotated[
    str | None, typer.Option(metavar="KIND", help="Shadows on surfaces: hard, or soft (percentage-closer filtering).")
]
ShadowStorage = Annotated[
    str | None, typer.Option(metavar="KIND", help="Where the fog reads the shadow map: a texture or a buffer.")
]
Composition = Annotated[
    str | None,
    typer.Option(metavar="KIND", help="Fog on both of the surface light's legs (physical), or as Eq. 14 is printed."),
]
