"""Imports run one way: experiments -> gpu_impl, reference -> scenes -> analytic.

gpu_impl and reference never import each other: that one is not made from the other is what makes their comparison
worth anything.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = {"analytic", "scenes", "gpu_impl", "reference", "experiments"}
RENDERERS = {"mitsuba", "drjit", "moderngl"}

# What each package may not import, directly or inside a function.
FORBIDDEN = {
    "analytic": PACKAGES - {"analytic"} | RENDERERS | {"airlight"},
    "scenes": {"gpu_impl", "reference", "experiments", "airlight", "moderngl"},
    "gpu_impl": {"reference", "experiments", "airlight", "mitsuba", "drjit"},
    "reference": {"gpu_impl", "experiments", "airlight", "moderngl"},
    "experiments": set(),
}


def imported(source: str) -> Iterator[tuple[int, str]]:
    """Yield the line and the top-level module of every import in `source`, those inside functions too."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name.split(".")[0]) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.lineno, (node.module or "").split(".")[0]
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            # importlib.import_module("...") and __import__("...")
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if name in {"import_module", "__import__"}:
                yield node.lineno, str(node.args[0].value).split(".")[0]


def violations(root: Path) -> list[str]:
    """List every forbidden import below `root` as "file:line imports module"."""
    return [
        f"{path.relative_to(root)}:{line} imports {module}"
        for package, forbidden in FORBIDDEN.items()
        for path in sorted((root / package).rglob("*.py"))
        for line, module in imported(path.read_text(encoding="utf-8"))
        if module in forbidden
    ]


def test_imports_run_one_way() -> None:
    assert violations(ROOT) == []


def test_every_package_is_there_to_be_checked() -> None:
    assert {path.parent.name for path in ROOT.glob("*/__init__.py")} - {"tests"} == PACKAGES


@pytest.mark.parametrize(
    ("package", "statement", "module"),
    [
        ("gpu_impl", "import reference.integrator", "reference"),
        ("reference", "from gpu_impl import techniques", "gpu_impl"),
        ("scenes", "def f():\n    from moderngl import Context", "moderngl"),
        ("analytic", "class A:\n    def f(self):\n        import numpy, drjit.llvm as d", "drjit"),
        ("analytic", "from scenes.model import Scene", "scenes"),
        ("gpu_impl", "import importlib\nimportlib.import_module('mitsuba')", "mitsuba"),
        ("reference", "import airlight", "airlight"),
    ],
)
def test_a_planted_violation_is_caught(tmp_path: Path, package: str, statement: str, module: str) -> None:
    (tmp_path / package / "deep").mkdir(parents=True)
    (tmp_path / package / "deep" / "planted.py").write_text(statement, encoding="utf-8")
    found = violations(tmp_path)
    assert len(found) == 1
    assert found[0].startswith(f"{package}/deep/planted.py:")
    assert found[0].endswith(f"imports {module}")


def test_what_is_allowed_passes(tmp_path: Path) -> None:
    (tmp_path / "experiments").mkdir()
    (tmp_path / "experiments" / "cli.py").write_text("import gpu_impl, reference, scenes, analytic", encoding="utf-8")
    (tmp_path / "scenes").mkdir()
    (tmp_path / "scenes" / "own.py").write_text("from . import reference\nimport mitsuba", encoding="utf-8")
    assert violations(tmp_path) == []
