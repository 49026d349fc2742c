"""Shaders that are other than they stand in the files, for a while, in this process."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from gpu_impl import shader_source
from gpu_impl.device import shared_device
from scenes.errors import InputError


@dataclass(frozen=True)
class Edit:
    """A piece of a shader's text and what takes its place.

    Attributes
    ----------
    file : str    below gpu_impl/shaders
    old : str     stands there once
    new : str
    """

    file: str
    old: str
    new: str

    def applied(self, text: str) -> str:
        """The text with the edit.

        Raises
        ------
        InputError
            The piece is not there, or there more than once: the shader has changed since the edit was written.
        """
        if (count := text.count(self.old)) != 1:
            raise InputError(
                f"The text '{self.old}' stands {count} times in gpu_impl/shaders/{self.file}, and an edit of "
                "experiments/gate changes it where it stands once: the shader has changed, so adapt the edit."
            )
        return text.replace(self.old, self.new)


@contextmanager
def changed_shaders(edits: Sequence[Edit] = (), header: str = "") -> Iterator[None]:
    """Compile shaders with edits meanwhile; renderers that are made before or after know nothing of it.

    Parameters
    ----------
    header : lines that come before everything else in each shader

    Raises
    ------
    InputError
        An edit's text does not stand in its file once; or the file is not there.
    """
    before = shader_source.SHADERS, shader_source.HEADER
    with tempfile.TemporaryDirectory(prefix="airlight-shaders-") as name:
        folder = Path(name) / "shaders"
        shutil.copytree(before[0], folder)
        for edit in edits:
            if not (path := folder / edit.file).is_file():
                raise InputError(f"There is no shader {edit.file}; an edit of experiments/gate changes it: adapt that.")
            path.write_text(edit.applied(path.read_text(encoding="utf-8")), encoding="utf-8")
        shader_source.SHADERS, shader_source.HEADER = folder, before[1] + header
        _forget_programs()
        try:
            yield
        finally:
            shader_source.SHADERS, shader_source.HEADER = before
            _forget_programs()


def _forget_programs() -> None:
    """Let the process's device compile anew: it keeps programs by their files' names."""
    shared_device().release()
