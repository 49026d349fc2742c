"""`airlight audit`, `atlas`, `quadrature` and `spectra`: the mathematics alone, without a renderer."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def audit(
    json: Annotated[bool, typer.Option("--json", help="Print a list of objects and nothing else.")] = False,
    out: Annotated[Path | None, typer.Option(help="Folder in which audit.json and README.md are written.")] = None,
) -> None:
    """Evaluate the thesis's equations, as printed and repaired, against independent truths.

    Exits with 1 where a repair fails.  Example: airlight audit
    """
    from experiments.audit.report import run_audit

    if not run_audit(json, out):
        raise typer.Exit(1)


def atlas(
    out: Annotated[Path, typer.Option(help="Folder for the maps, the tables and the page; what it holds is replaced.")],
) -> None:
    """Map every airlight model's error over optical distance and length, and count and time what a segment costs.

    Example: airlight atlas --out results/atlas
    """
    from experiments.atlas.atlas import write_atlas
    from experiments.atlas.exponential_integral_map import write_map
    from experiments.atlas.page import TITLE
    from experiments.console import notices, say
    from experiments.pages import prepare_page

    prepare_page(out, TITLE)
    with notices.status("atlas") as status:
        write_map(out)
        write_atlas(out, status.update)
    say(f"Atlas: {(out / 'README.md').resolve()}")


def quadrature(out: Annotated[Path, typer.Option(help="Folder for the page.")]) -> None:
    """Measure how many exponentials the airlight needs: tuned nodes beside Gauss-Legendre.

    Example: airlight quadrature --out results/quadrature
    """
    from experiments.console import say
    from experiments.quadrature.study import write_study

    write_study(out)
    say(f"Quadrature: {(out / 'README.md').resolve()}")


def spectra(
    out: Annotated[Path, typer.Option(help="Folder for the table, the figure and the page.")],
) -> None:
    """Measure what three bands get wrong against the spectrum: air, fog, haze, stained water.

    Example: airlight spectra --out results/spectra
    """
    from experiments.console import say
    from experiments.spectra.page import write_spectra

    write_spectra(out)
    say(f"Spectra: {(out / 'README.md').resolve()}")
