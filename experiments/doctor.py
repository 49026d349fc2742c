"""Looks at what airlight needs on this machine, and says the cure where something is missing."""

from __future__ import annotations

import os
import platform
import re
import sys
from dataclasses import dataclass
from importlib.metadata import requires

from rich.table import Table

from experiments.provenance import package_version
from scenes.errors import InputError


@dataclass(frozen=True)
class Finding:
    """One line of the report: `state` is "ok", "note" (works, with a limit) or "missing" (the main job cannot run)."""

    what: str
    state: str
    detail: str
    cure: str = ""


def examine() -> list[Finding]:
    """Look at everything; whatever a part raises is what was found of it."""
    findings = []
    for what, look in (("Python", _python), ("OpenGL", _gl), ("Mitsuba", _mitsuba), ("meshes", _meshes)):
        try:
            findings += look()
        except InputError as error:
            findings.append(Finding(what, "missing", "does not work", str(error)))
        except Exception as error:
            # a package that is broken or gone raises what it likes
            findings.append(Finding(what, "missing", f"{type(error).__name__}: {error}", "run `make setup`"))
    return findings


def report(findings: list[Finding]) -> Table:
    """Findings as a table."""
    table = Table(title="airlight doctor", title_justify="left")
    for heading in ("what", "", "found", "cure"):
        table.add_column(heading, overflow="fold")
    marks = {"ok": "[green]ok[/green]", "note": "[yellow]note[/yellow]", "missing": "[red]missing[/red]"}
    for finding in findings:
        table.add_row(finding.what, marks[finding.state], finding.detail, finding.cure)
    return table


def _python() -> list[Finding]:
    supported = (3, 11) <= sys.version_info < (3, 14)
    found = [
        Finding(
            "Python",
            "ok" if supported else "note",
            platform.python_version(),
            "" if supported else "use Python 3.11 to 3.13",
        )
    ]
    # "name~=1.2; extra == ..." are not needed to run
    needed = [re.split(r"[^\w.-]", line)[0] for line in requires("airlight") or () if "extra ==" not in line]
    versions = {name: package_version(name) for name in needed}
    absent = [name for name, version in versions.items() if version == "missing"]
    detail = ", ".join(f"{name} {version}" for name, version in versions.items())
    cure = "run `make setup`" if absent else ""
    return [*found, Finding("packages", "missing" if absent else "ok", detail, cure)]


def _gl() -> list[Finding]:
    from gpu_impl.device import shared_device
    from gpu_impl.passes.shadow_volume import check_polygons

    device = shared_device()
    note = " (software: timings are wall clock)" if device.info.is_software else ""
    found = [Finding("OpenGL", "ok", f"{device.info.renderer}, {device.info.version}{note}")]
    try:
        check_polygons(device)
    except InputError as error:
        return [*found, Finding("shadow polygons", "missing", "cannot be drawn", str(error))]
    return [*found, Finding("shadow polygons", "ok", "can be drawn")]


def _mitsuba() -> list[Finding]:
    from scenes.llvm import choose_llvm
    from scenes.mitsuba_setup import VARIANTS, mitsuba, variant_works

    choice = choose_llvm()
    passed_over = "; ".join(f"{rejected.path}: {rejected.reason}" for rejected in choice.rejected)
    detail = f"{choice.usable.path} (LLVM {choice.usable.version})" if choice.usable else "none that Dr.Jit can use"
    llvm = Finding(
        "LLVM",
        "ok" if choice.usable else "note",
        detail + (f"\npassed over: {passed_over}" if passed_over else ""),
        "" if choice.usable else "run `make setup`, or `apt-get install libllvm19`, or set DRJIT_LIBLLVM_PATH",
    )
    try:
        mi = mitsuba()
    except InputError as error:
        return [llvm, Finding("Mitsuba", "missing", "does not work", str(error))]
    works = {variant: variant_works(mi, variant, choice) for variant in VARIANTS}
    lines = [f"{variant}: {'works' if ok else 'does not work'}" for variant, ok in works.items()]
    used = mi.variant()
    slow = used == "scalar_rgb"
    cure = "references are slow and averaged over pixels until an LLVM works" if slow else ""
    return [llvm, Finding("Mitsuba", "note" if slow else "ok", "\n".join([*lines, f"used: {used}"]), cure)]


def _meshes() -> list[Finding]:
    from scenes.meshes.files import available

    folder = os.environ.get("AIRLIGHT_MESH_DIR", "not set")
    meshes = available()
    stand_ins = any(mesh.is_stand_in for mesh in meshes)
    lines = [f"{mesh.name}: {mesh.origin}" for mesh in meshes]
    cure = "set AIRLIGHT_MESH_DIR to a folder with the meshes to use the real ones" if stand_ins else ""
    return [Finding("meshes", "note" if stand_ins else "ok", "\n".join([f"AIRLIGHT_MESH_DIR: {folder}", *lines]), cure)]
