"""Shader files that are no part of airlight, with what they include from beside them; named by what they hold.

A name such as `march.glsl@3fa9c2d1e0b4` stands for one text: whoever changes the file has another part, and no program
that was compiled before is taken for it.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path

from gpu_impl import shader_source
from gpu_impl.shader_source import INCLUDE, OWN_FILES, OwnFile
from scenes.errors import InputError
from scenes.file_names import check_name

DIGITS = 12


class OwnFiles:
    """Reads files, each once, and remembers what they hold.

    Parameters
    ----------
    given : what files hold, by their paths, in place of the disk

    Attributes
    ----------
    texts : dict    path to text of every file that was read
    """

    def __init__(self, given: Mapping[str, str] | None = None) -> None:
        self.texts: dict[str, str] = {}
        self._given = given

    def read(self, path: Path) -> str:
        """Text of a file.

        Raises
        ------
        InputError
            It is not there, cannot be read or is not UTF-8.
        """
        check_name(path)
        if str(path) not in self.texts:
            try:
                kept = self._given[str(path)] if self._given is not None else None
                self.texts[str(path)] = path.read_text(encoding="utf-8") if kept is None else kept
            except KeyError:
                raise InputError(f"{path} is not among the files that are given.") from None
            except OSError as error:
                raise InputError(f"{path} cannot be read ({error.strerror}).") from None
            except ValueError:
                raise InputError(f"{path} is not UTF-8; save it as such.") from None
        return self.texts[str(path)]

    def has(self, path: Path) -> bool:
        """Whether there is such a file."""
        return str(path) in self._given if self._given is not None else path.is_file()

    def shader(self, path: Path, above: tuple[Path, ...] = ()) -> str:
        """Make a shader file known to `ShaderSource`, with those beside it that it includes; its name there.

        Parameters
        ----------
        above : the files that it is included by

        Raises
        ------
        InputError
            It or one of those cannot be read, includes itself, or what is neither beside it nor one of airlight's.
        """
        lines = []
        for number, line in enumerate(self.read(path).splitlines(keepends=True), start=1):
            include = INCLUDE.match(line)
            # <airlight>, <phase> and the like are put in where the program is made
            if include and not include[1].startswith("<"):
                name = self._included(path, number, include[1], (*above, path))
                line = line.replace(include[1], name)
            lines.append(line)
        text = "".join(lines)
        # with its includes' names, and so with what they hold
        name = f"{path.name}@{hashlib.sha256(text.encode()).hexdigest()[:DIGITS]}"
        OWN_FILES[name] = OwnFile(str(path), text)
        return name

    def _included(self, path: Path, number: int, include: str, above: tuple[Path, ...]) -> str:
        # one path for one file, or the way back to itself would never end
        beside = Path(os.path.normpath(path.parent / include))
        if self.has(beside):
            if beside in above:
                raise InputError(f"{path}:{number}: {include} includes itself; take the include out.")
            return self.shader(beside, above)
        if not (shader_source.SHADERS / include).is_file():
            raise InputError(
                f"{path}:{number}: there is no {include}, neither beside this file nor among airlight's shaders."
            )
        return include
