"""`airlight render`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from experiments.options import SCENE_HELP, Parameters, Size, given_beside, parse_parameters
from experiments.technique_options import (
    AirlightModel,
    Composition,
    Downsample,
    LatticeName,
    ShadowMapSize,
    ShadowSource,
    ShadowStorage,
    Steps,
    SurfaceShadows,
    Upsample,
    Visibility,
)
from scenes.errors import InputError


def render(
    context: typer.Context,
    scene: Annotated[str | None, typer.Argument(metavar="SCENE", help=SCENE_HELP)] = None,
    out: Annotated[Path | None, typer.Option(help="The EXR file to write; F-again.exr beside --again F.exr.")] = None,
    technique: Annotated[
        str, typer.Option(help="A technique, a cell such as lit_intervals+quadrature, or a TOML file of your own.")
    ] = "Weng2010",
    parameter: Parameters = None,
    size: Size = None,
    visibility: Visibility = None,
    airlight_model: AirlightModel = None,
    steps: Steps = None,
    shadow_map: ShadowMapSize = None,
    lattice: LatticeName = None,
    downsample: Downsample = None,
    upsample: Upsample = None,
    surface_shadows: SurfaceShadows = None,
    shadow_storage: ShadowStorage = None,
    shadow_source: ShadowSource = None,
    composition: Composition = None,
    again: Annotated[
        Path | None,
        typer.Option(
            metavar="F.exr",
            help="Draw what this file holds again, as its metadata say, and compare; SCENE only where that has moved.",
        ),
    ] = None,
) -> None:
    """Draw a scene with an OpenGL technique and write a layered EXR.

    Example: airlight render donut_dragon --technique Weng2010 --size 512 512 --out dragon.exr

    With --again it exits with 1 where the same program on the same renderer draws other pixels.
    """
    if again:
        if given := given_beside(context, ("scene", "out", "again")):
            raise InputError(f"--again takes everything from {again}; leave {' and '.join(given)} out.")
        _render_again(again, scene, out)
        return
    if scene is None or out is None:
        raise InputError("render needs a SCENE and --out, or --again with a file that it wrote.")
    import airlight
    from experiments.console import say, warn
    from experiments.exr import check_writable
    from experiments.renderers import open_renderer
    from experiments.terminal import announce_scene
    from gpu_impl.techniques import find_technique

    settings = {
        "visibility": visibility,
        "airlight": airlight_model,
        "steps": steps,
        "shadow_map": shadow_map,
        "lattice": lattice,
        "downsample": downsample,
        "upsample": upsample,
        "surface_shadows": surface_shadows,
        "shadow_storage": shadow_storage,
        "shadow_source": shadow_source,
        "composition": composition,
    }
    check_writable(out, ".exr")
    loaded = airlight.load(scene, size, **parse_parameters(parameter))
    announce_scene(loaded)
    chosen = find_technique(technique, **settings)
    for notice in chosen.notices(loaded):
        warn(notice)
    with open_renderer(loaded) as renderer:
        frame = renderer.render(chosen)
        cost = "a control" if chosen.asks_rays else f"{renderer.milliseconds(chosen):.1f} ms a frame"
    airlight.save(out, loaded, frame)
    say(
        f"{out}: {loaded.name}, {frame.technique.name}, {cost} on {frame.gl.renderer}"
        + ("" if chosen.asks_rays else " (median of 5, wall clock around glFinish)")
    )


def _render_again(again: Path, scene: str | None, out: Path | None) -> None:
    import airlight
    from experiments.again import draw_again
    from experiments.console import say
    from experiments.exr import check_writable
    from experiments.terminal import announce_scene

    out = out or again.parent / f"{again.stem}-again.exr"
    check_writable(out, ".exr")
    if out.resolve() == again.resolve():
        raise InputError(f"{again} is what the new picture is compared with; choose another --out.")
    result = draw_again(again, scene)
    announce_scene(result.scene)
    airlight.save(out, result.scene, result.frame)
    say(f"{out}: {result.report(again)}.")
    if not result.is_expected:
        raise typer.Exit(1)
