"""What there is: scenes, techniques and their parts, suites, meshes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields

from rich.table import Table

from analytic import MODELS
from experiments.suite import shipped as shipped_suites
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.lattices import LATTICES
from gpu_impl.techniques import CHOICES, RANGES, SETTINGS, TECHNIQUES, Technique
from gpu_impl.visibilities import VISIBILITIES
from scenes.catalogue import FOLDER, shipped
from scenes.meshes.files import available


def listing() -> list[Table]:
    """One table per kind."""
    return [
        _table("scenes", ("name", "file"), [(name, f"{FOLDER.name}/{name}.xml") for name in shipped()]),
        _table(
            "techniques (any other cell runs as visibility+airlight)",
            ("name", "visibility", "airlight model", "lattice", "steps", "shadow map"),
            [
                (t.name, t.visibility, t.airlight, t.lattice, str(t.steps), str(t.shadow_map))
                for t in TECHNIQUES.values()
            ],
        ),
        _table("visibilities", ("name", "what"), [(name, part.what) for name, part in VISIBILITIES.items()]),
        _table(
            "airlight models of the techniques",
            ("name", "what", "phase functions"),
            [(name, part.what, ", ".join(part.phases or ("any",))) for name, part in AIRLIGHT_MODELS.items()],
        ),
        _table(
            "airlight models of the library (analytic.MODELS)",
            ("name", "source", "phase functions"),
            [(name, model.citation, ", ".join(model.phases or ("any",))) for name, model in MODELS.items()],
        ),
        _table("lattices", ("name", "what"), [(name, kind.what) for name, kind in LATTICES.items()]),
        _table("settings of a technique", ("name", "may be", "by default"), list(_settings())),
        _table("suites", ("name",), [(name,) for name in shipped_suites()]),
        _table("meshes", ("name", "from", "path"), [(m.name, m.origin, str(m.path)) for m in available()]),
    ]


def _settings() -> Iterator[tuple[str, ...]]:
    # visibility and airlight model have tables of their own
    defaults = {field.name: field.default for field in fields(Technique)}
    for name in SETTINGS:
        choices = ", ".join(map(str, CHOICES[name])) if name in CHOICES else "{} to {}".format(*RANGES[name])
        yield name, choices, str(defaults[name])


def _table(title: str, headings: tuple[str, ...], rows: list[tuple[str, ...]]) -> Table:
    table = Table(title=title, title_justify="left")
    for heading in headings:
        table.add_column(heading, overflow="fold")
    for row in rows:
        table.add_row(*row)
    return table
