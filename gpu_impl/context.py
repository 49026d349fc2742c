"""An OpenGL context without a window."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

from scenes.errors import InputError

GL_VERSION = 430


@dataclass(frozen=True)
class GLInfo:
    """What draws: the strings that results are published with."""

    renderer: str
    version: str

    @property
    def is_software(self) -> bool:
        """Whether a CPU rasterises; its timer queries cannot be believed."""
        return any(name in self.renderer.lower() for name in ("llvmpipe", "softpipe", "swrast"))


def create_context() -> Any:
    """Open a headless context (EGL).

    Raises
    ------
    InputError
        There is no EGL, or none that offers OpenGL 4.3.
    """
    import moderngl

    settings: dict[str, Any] = {"backend": "egl"}
    try:
        return moderngl.create_context(GL_VERSION, standalone=True, **settings)
    except Exception as error:
        # glcontext raises bare exceptions of several types; each means that no context came
        raise InputError(
            f"No OpenGL {GL_VERSION / 100:.1f} context could be opened without a window, through EGL "
            f"({str(error).strip()}): run `make setup`, or `apt-get install libegl1 libgl1 libgl1-mesa-dri` for the "
            "software renderer."
        ) from None


@cache
def shared_context() -> Any:
    """Return the process's own context, opened at the first call."""
    return create_context()


def gl_info(context: Any) -> GLInfo:
    """Ask a context who draws."""
    return GLInfo(context.info["GL_RENDERER"], context.info["GL_VERSION"])
