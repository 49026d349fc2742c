"""`airlight compare`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from experiments.options import given_beside
from scenes.errors import InputError

if TYPE_CHECKING:
    from rich.table import Table

    from experiments.heat_maps.heat_map import HeatMap


def compare(
    context: typer.Context,
    pictures: Annotated[
        list[Path],
        typer.Argument(
            metavar="F.exr... REFERENCE.exr", help="Pictures to judge, any program's EXR; last the reference."
        ),
    ],
    layer: Annotated[str, typer.Option(help="Which layer: composite, scattering or surface.")] = "composite",
    heatmap: Annotated[
        Path | None, typer.Option(help="Write a PNG with the pictures and their errors, all on one scale.")
    ] = None,
    map_: Annotated[
        Literal["both", "signed", "absolute"], typer.Option("--map", help="Which errors the heat maps show.")
    ] = "both",
    unit: Annotated[
        Literal["relative", "radiance"] | None,
        typer.Option(help="Errors of the pixel, in per cent, or in radiance; signed: relative, absolute: radiance."),
    ] = None,
    scale: Annotated[
        Literal["log", "linear"], typer.Option(help="log: logarithmic beyond a linear piece about zero.")
    ] = "log",
    range_: Annotated[
        float | None,
        typer.Option(
            "--range",
            metavar="ERROR",
            help="Error at the scale's end, in its unit; by default 100 % (log) or 20 % of the pixel, or of white.",
        ),
    ] = None,
    colours: Annotated[
        Literal["even", "hue"],
        typer.Option(help="Of absolute errors: perceptually even, or the thesis's hue from blue to red."),
    ] = "even",
    json: Annotated[bool, typer.Option("--json", help="Print the metrics as JSON.")] = False,
) -> None:
    """Measure how far pictures are from their reference.

    Example: airlight compare dragon.exr reference.exr --layer scattering --heatmap error.png
    """
    import json as json_module
    from dataclasses import asdict

    import airlight
    from experiments.compare import compare_all, notices
    from experiments.console import console, say, warn

    if len(pictures) < 2:
        raise InputError("Give at least one picture, and its reference after it.")
    heat_maps = _heat_maps(map_, unit, scale == "log", range_, colours)
    if not heatmap and (given := given_beside(context, ("pictures", "layer", "json"))):
        raise InputError(f"Without --heatmap, the PNG to write, there is nothing to draw with {' and '.join(given)}.")
    *tests, truth = (airlight.read(picture) for picture in pictures)
    metrics = [asdict(found) for found in compare_all(tests, truth, layer=layer, sheet=heatmap, heat_maps=heat_maps)]
    # the reference's own once
    for notice in dict.fromkeys(notice for test in tests for notice in notices(test, truth, layer)):
        warn(notice)
    if json:
        rows = [{"layer": layer, **found} for found in metrics]
        if len(tests) > 1:
            rows = [{"picture": str(test.path), **row} for test, row in zip(tests, rows, strict=True)]
        print(json_module.dumps(rows if len(tests) > 1 else rows[0]))
        return
    console.print(_table(layer, [test.path.name for test in tests], metrics))
    if heatmap:
        say(f"Heat map: {heatmap}")


def _heat_maps(
    which: Literal["both", "signed", "absolute"],
    unit: Literal["relative", "radiance"] | None,
    logarithmic: bool,
    limit: float | None,
    colours: Literal["even", "hue"],
) -> list[HeatMap]:
    """What the options ask for, or InputError where they contradict each other."""
    from experiments.heat_maps.heat_map import HeatMap

    if limit is not None and which == "both" and not unit:
        raise InputError("--range is in one unit: say which error or which unit it is meant for, by --map or --unit.")
    if limit is not None and not 0 < limit < float("inf"):
        raise InputError(f"--range {limit:g} is no scale; give a positive number.")
    if colours == "hue" and which == "signed":
        raise InputError("--colours hue is of absolute errors, for it has no middle; give --map absolute.")
    maps = []
    if which != "absolute":
        maps.append(HeatMap(True, unit or "relative", logarithmic, limit))
    if which != "signed":
        maps.append(HeatMap(False, unit or "radiance", logarithmic, limit, colours))
    return maps


def _table(layer: str, names: list[str], metrics: list[dict[str, float | None]]) -> Table:
    """All metrics of one layer, a line each, a column a picture."""
    from rich.table import Table
    from rich.text import Text

    table = Table(title=f"{layer} against the reference", title_justify="left")
    table.add_column("metric")
    for name in names:
        # a name is no markup
        table.add_column(Text(name) if len(names) > 1 else "value", justify="right", overflow="fold")
    for metric in metrics[0]:
        values = [found[metric] for found in metrics]
        table.add_row(metric, *("-" if value is None else f"{value:.6g}" for value in values))
    return table
