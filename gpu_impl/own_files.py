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
# between a file's name and what it holds, and in no name of airlight's own
OWN = "@"
TAKES = "a technique takes files from its own folder and from those in it: put it there"


def _is_below(path: Path, folder: Path) -> bool:
    # where links lead
    return path.resolve().is_relative_to(folder.resolve())


def _way_out(include: str) -> str:
    if (shader_source.SHADERS / include).is_file():
        return "a file beside goes before airlight's of the same name, so call yours otherwise"
    return "take the include out"


class OwnFiles:
    """Reads files, each once, and remembers what they hold.

    What they hold goes into pictures, which people pass on. So files from the disk are those below one folder alone: no
    technique that somebody was sent takes others along.

    Parameters
    ----------
    folder : that of the technique's TOML file
    given : what files hold, by their paths, in place of the disk

    Attributes
    ----------
    texts : dict    path to text of every file that was read
    """

    def __init__(self, folder: Path, given: Mapping[str, str] | None = None) -> None:
        self.texts: dict[str, str] = {}
        self._folder = folder
        self._given = given

    def read(self, path: Path) -> str:
        """Text of a file.

        Raises
        ------
        InputError
            It is not there, cannot be read, is not UTF-8, or is no file that a technique may take.
        """
        check_name(path)
        if not self._may_take(path):
            raise InputError(f"{path} is outside of {self._folder}; {TAKES}.")
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

    def _may_take(self, path: Path) -> bool:
        return self._given is not None or _is_below(path, self._folder)

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
                line = line[: include.start(1)] + name + line[include.end(1) :]
            lines.append(line)
        text = "".join(lines)
        # with its includes' names, and so with what they hold
        name = f"{path.name}{OWN}{hashlib.sha256(text.encode()).hexdigest()[:DIGITS]}"
        OWN_FILES[name] = OwnFile(str(path), text)
        return name

    def _included(self, path: Path, number: int, include: str, above: tuple[Path, ...]) -> str:
        # one path for one file, or the way back to itself would never end
        beside = Path(os.path.normpath(path.parent / include))
        if self.has(beside):
            if not self._may_take(beside):
                raise InputError(f"{path}:{number}: {include} is outside of {self._folder}; {TAKES}.")
            if beside in above:
                raise InputError(f"{path}:{number}: {include} includes itself; {_way_out(include)}.")
            return self.shader(beside, above)
        ours = shader_source.SHADERS / include
        # nor the way from there to any other file
        if not (ours.is_file() and _is_below(ours, shader_source.SHADERS)):
            raise InputError(
                f"{path}:{number}: there is no {include}, neither beside this file nor among airlight's shaders."
            )
        return include
