"""Puts shaders together from files with `#include`, and names the file and line when one does not compile."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from scenes.errors import InputError
from scenes.messages import readable

SHADERS = Path(__file__).parent / "shaders"
HEADER = "#version 430 core\n"
# nothing behind it but a comment
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"\s*(?://.*|/\*.*\*/\s*)?$')
# in a file
MOST_LINES = 100_000
# Mesa: "2:14(5): error", NVIDIA: "2(14) : error", others: "2:14: error"
_PLACE = re.compile(r"^(?:ERROR:\s*)?(\d+)[:(](\d+)", re.MULTILINE)


def _told(number: int, line: int) -> str:
    """File and line as `#line` has them: the line says both, as Mesa reports a call of no function in file 0."""
    return f"{number * MOST_LINES + line} {number}"


@dataclass(frozen=True)
class OwnFile:
    """A shader file that is no part of airlight, as it was when it was read.

    Attributes
    ----------
    path : str    where, for messages
    text : str
    """

    path: str
    text: str


# by the names that includes and registries have for them; own_files.py puts them there
OWN_FILES: dict[str, OwnFile] = {}


def _shown(name: str) -> str:
    """A shader file as messages have it."""
    return OWN_FILES[name].path if name in OWN_FILES else name


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
        own = OWN_FILES.get(name)
        text = own.text if own else self._generated.get(name)
        if text is None:
            text = (SHADERS / name).read_text()
        lines = [f"#line {_told(number, 1)}\n"]
        for line_number, line in enumerate(text.splitlines(keepends=True), start=1):
            include = INCLUDE.match(line)
            if include and not self._knows(include[1]):
                raise self._unknown(f"{_shown(name)}:{line_number}", include[1])
            lines.append(self._expand(include[1]) + f"#line {_told(number, line_number + 1)}\n" if include else line)
        return "".join(lines) + "\n"

    def _knows(self, include: str) -> bool:
        return not include.startswith("<") or include in self._includes or include in self._generated

    def _unknown(self, place: str, include: str) -> Exception:
        message = f"{place}: there is no {include} here"
        if not self.own_files:
            return ShaderError(message)
        known = ", ".join((*self._includes, *self._generated)) or "none such"
        return InputError(
            f'{message}, but {known}; a model with supply = "NAME" has the computed includes of the registered one, '
            "for the phase functions that it takes."
        )

    @property
    def own_files(self) -> list[str]:
        """Paths of those of its files that are no part of airlight."""
        return [OWN_FILES[name].path for name in self.files if name in OWN_FILES]

    def name_files(self, message: str) -> str:
        """Replace the file numbers of a compiler's message by names."""
        shown = [_shown(name) for name in self.files]

        def named(place: re.Match[str]) -> str:
            number, line = divmod(int(place[2]), MOST_LINES)
            return f"{shown[number] if number < len(shown) else number}:{line}"

        return _PLACE.sub(named, message)

    def failure(self, error: Exception) -> Exception:
        """What to raise where it does not compile: one sentence where a file of somebody's own is in it."""
        message = self.name_files(str(error))
        if not self.own_files:
            return ShaderError(message)
        lines = [line.strip() for line in message.splitlines() if "error" in line.lower()]
        for line in lines:
            if line.startswith(tuple(self.own_files)):
                return InputError(f"{readable(line)}.")
        # a function that is missing is missing nowhere, and some compilers never say "error"
        said = lines[0] if lines else " ".join(message.split())
        return InputError(f"The shader with {' and '.join(self.own_files)} does not compile: {readable(said)}.")


def compile_program(context: Any, vertex: ShaderSource, fragment: ShaderSource) -> Any:
    """Compile and link.

    Raises
    ------
    ShaderError
        With the name and line of each file that the compiler complained about.
    InputError
        The same, where a file is in it that is no part of airlight.
    """
    try:
        return context.program(vertex_shader=vertex.text, fragment_shader=fragment.text)
    except Exception as error:
        # moderngl raises its bare Error; which of the two shaders failed stands in its heading
        source = vertex if "vertex_shader" in str(error) and "fragment_shader" not in str(error) else fragment
        raise source.failure(error) from None


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
