"""An OpenGL context with the programs compiled on it, each once."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from gpu_impl.context import gl_info, shared_context
from gpu_impl.shader_source import ShaderSource, compile_program


class Device:
    """Compiles programs and runs full-screen passes.

    Parameters
    ----------
    context : moderngl.Context
    """

    def __init__(self, context: Any) -> None:
        self.context = context
        self.info = gl_info(self.context)
        self.largest_texture: int = self.context.info["GL_MAX_TEXTURE_SIZE"]
        self._programs: dict[tuple, Any] = {}

    def program(
        self,
        fragment: str,
        vertex: str = "fullscreen.vert.glsl",
        defines: Mapping[str, object] | None = None,
        includes: Mapping[str, str] | None = None,
        generated: Mapping[str, str] | None = None,
    ) -> Any:
        """Return the program of two shader files below `shaders/`; see `ShaderSource` for the rest."""
        defines, includes, generated = defines or {}, includes or {}, generated or {}
        key = (vertex, fragment, *(item for texts in (defines, includes, generated) for item in sorted(texts.items())))
        if key not in self._programs:
            self._programs[key] = compile_program(
                self.context,
                ShaderSource(vertex),
                ShaderSource(fragment, defines, includes, generated),
            )
        return self._programs[key]

    def texture(self, size: tuple[int, int], components: int) -> Any:
        """Make a float32 texture that is read without interpolation."""
        texture = self.context.texture(size, components, dtype="f4")
        texture.filter = (self.context.NEAREST, self.context.NEAREST)
        return texture

    def fill(self, program: Any, *textures: Any, add: bool = False) -> None:
        """Run a program on every pixel of textures of one size, in place of what is there or added to it."""
        target = self.context.framebuffer(color_attachments=textures)
        target.use()
        if add:
            self.context.enable(self.context.BLEND)
            self.context.blend_func = self.context.ONE, self.context.ONE
        array = self.context.vertex_array(program, [])
        array.render(vertices=3)
        self.context.disable(self.context.BLEND)
        array.release()
        target.release()

    def release(self) -> None:
        """Give the programs back."""
        for program in self._programs.values():
            program.release()
        self._programs.clear()


@cache
def shared_device() -> Device:
    """Return the process's own device: what it compiled for one scene serves the next."""
    return Device(shared_context())
