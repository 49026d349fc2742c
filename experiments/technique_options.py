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
LatticeName = Annotated[
    str | None, typer.Option("--lattice", metavar="L", help="On which rays fog is evaluated (`airlight list`).")
]
Downsample = Annotated[
    int | None, typer.Option(metavar="N", help="How coarse the lattice is: every N-th pixel of the grid.")
]
Upsample = Annotated[
    str | None, typer.Option(metavar="U", help="What fills the pixels between those of the grid (`airlight list`).")
]
SurfaceShadows = Annotated[
    str | None, typer.Option(metavar="KIND", help="Shadows on surfaces: hard, or soft (percentage-closer filtering).")
]
ShadowStorage = Annotated[
    str | None, typer.Option(metavar="KIND", help="Where the fog reads the shadow map: a texture or a buffer.")
]
ShadowSource = Annotated[
    str | None,
    typer.Option(
        metavar="KIND", help="What says where it is dark: the shadow map, or rays of the reference, a control."
    ),
]
Composition = Annotated[
    str | None,
    typer.Option(metavar="KIND", help="Fog on both of the surface light's legs (physical), or as Eq. 14 is printed."),
]
