"""Puts shaders together from files with `#include`, and names the file and line when one does not compile."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

SHADERS = Path(__file__).parent / "shaders"
HEADER = "#version 430 core\n"
_INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"\s*$')
# Mesa: "2:14(5): error", NVIDIA: "2(14) : error", others: "2:14: error"
_PLACE = re.compile(r"^(?:ERROR:\s*)?(\d+)[:(](\d+)", re.MULTILINE)


class ShaderError(RuntimeError):
    """A shader that does not compile: a mistake in our files, or in a technique that somebody is writing."""


class ShaderSource:
    """One shader, assembled.

    Parameters
    ----------
    main : path of the file below `shaders/`
    defines : names and values for `#define`, before everything else
    includes : what the names in `#include "<name>"` stand for: paths below `shaders/`, such as the airlight model
    generated : text for includes that are computed, such as quadrature nodes
    """

    def __init__(
        self,
        main: str,
        defines: Mapping[str, object] | None = None,
        includes: Mapping[str, str] | None = None,
        generated: Mapping[str, str] | None = None,
    ) -> None:
        self.files: list[str] = []
        self._includes = dict(includes or {})
        self._generated = dict(generated or {})
        defined = "".join(f"#define {name} {value}\n" for name, value in (defines or {}).items())
        self.text = HEADER + defined + self._expand(main)

    def _expand(self, name: str) -> str:
        name = self._includes.get(name, name)
        if name in self.files:
            return ""
        # GLSL knows files by number only; #line gives each its own
        number = len(self.files)
        self.files.append(name)
        text = self._generated.get(name) or (SHADERS / name).read_text()
        lines = [f"#line 1 {number}\n"]
        for line_number, line in enumerate(text.splitlines(keepends=True), start=1):
            include = _INCLUDE.match(line)
            lines.append(self._expand(include[1]) + f"#line {line_number + 1} {number}\n" if include else line)
        return "".join(lines) + "\n"

    def name_files(self, message: str) -> str:
        """Replace the file numbers of a compiler's message by names."""

        def named(place: re.Match[str]) -> str:
            number = int(place[1])
            return f"{self.files[number] if number < len(self.files) else number}:{place[2]}"

        return _PLACE.sub(named, message)


def compile_program(context: Any, vertex: ShaderSource, fragment: ShaderSource) -> Any:
    """Compile and link.

    Raises
    ------
    ShaderError
        With the name and line of each file that the compiler complained about.
    """
    try:
        return context.program(vertex_shader=vertex.text, fragment_shader=fragment.text)
    except Exception as error:
        # moderngl raises its bare Error; which of the two shaders failed stands in its heading
        source = vertex if "vertex_shader" in str(error) and "fragment_shader" not in str(error) else fragment
        raise ShaderError(source.name_files(str(error))) from None


def compile_compute(context: Any, source: ShaderSource) -> Any:
    """Compile a compute shader; raises as `compile_program` does."""
    try:
        return context.compute_shader(source.text)
    except Exception as error:
        raise ShaderError(source.name_files(str(error))) from None


def set_uniforms(program: Any, values: Mapping[str, Any]) -> None:
    """Set the uniforms that the program has; a compiler drops those that a variant does not use.

    Arrays are matrices, (4, 4) or (N, 4, 4); everything else is set as moderngl takes it.
    """
    for name, value in values.items():
        if name not in program:
            continue
        if isinstance(value, np.ndarray):
            # OpenGL keeps matrices by columns
            program[name].write(np.ascontiguousarray(value.swapaxes(-1, -2), np.float32))
        else:
            program[name].value = value
