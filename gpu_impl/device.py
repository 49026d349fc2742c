"""An OpenGL context with the programs compiled on it, each once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from typing import Any

import numpy as np

from gpu_impl.context import gl_info, shared_context
from gpu_impl.shader_source import ShaderSource, compile_compute, compile_program

# moderngl has no name for it
DEPTH_CLAMP = 0x864F


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
        self._spare: dict[tuple, list[Any]] = {}
        # what is in use, by identity
        self._taken: dict[int, Any] = {}

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
                ShaderSource(vertex, defines, includes, generated),
                ShaderSource(fragment, defines, includes, generated),
            )
        return self._programs[key]

    def compute(self, name: str, defines: Mapping[str, object] | None = None) -> Any:
        """Return the compute program of a shader file below `shaders/`."""
        key = (name, *sorted((defines or {}).items()))
        if key not in self._programs:
            self._programs[key] = compile_compute(self.context, ShaderSource(name, defines))
        return self._programs[key]

    def texture(self, size: tuple[int, ...], components: int, dtype: str = "f4") -> Any:
        """Take a texture that is read without interpolation, an array where `size` has layers; it holds anything.

        A frame takes what the frame before gave back: new ones cost as much as the passes that fill them.
        """
        spare = self._spare.get((size, components, dtype))
        if spare:
            texture = spare.pop()
        else:
            new = self.context.texture if len(size) == 2 else self.context.texture_array
            texture = new(size, components, dtype=dtype)
            texture.filter = (self.context.NEAREST, self.context.NEAREST)
        self._taken[id(texture)] = texture
        return texture

    def buffer(self, size: int) -> Any:
        """Take a buffer of `size` bytes, new or given back; what it holds is undefined."""
        spare = self._spare.get((size,))
        buffer = spare.pop() if spare else self.context.buffer(reserve=size)
        self._taken[id(buffer)] = buffer
        return buffer

    def give_back(self, *memory: Any) -> None:
        """Keep textures and buffers for whoever asks for one of their kind next."""
        self.keep(*memory)
        for one in memory:
            texture = hasattr(one, "components")
            kind = (one.size, one.components, one.dtype) if texture else (one.size,)
            self._spare.setdefault(kind, []).append(one)

    def keep(self, *memory: Any) -> None:
        """Leave textures and buffers to whoever took them, also where the drawing that they were taken for fails."""
        for one in memory:
            self._taken.pop(id(one), None)

    @contextmanager
    def taking_back(self) -> Iterator[None]:
        """Stand around a drawing: where it stops half-way, what it took and has neither given back nor kept is free."""
        before = set(self._taken)
        try:
            yield
        except BaseException:
            self.give_back(*[one for number, one in self._taken.items() if number not in before])
            raise

    def release_spare_textures(self) -> None:
        """Release what was given back."""
        for textures in self._spare.values():
            for texture in textures:
                texture.release()
        self._spare.clear()

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

    def begin_drawing(self) -> None:
        """Set what passes change and change back to how they expect it: one may have been interrupted in between."""
        context = self.context
        context.disable(context.BLEND | context.DEPTH_TEST | context.CULL_FACE | context.PROGRAM_POINT_SIZE)
        context.disable_direct(DEPTH_CLAMP)
        context.blend_equation, context.front_face = context.FUNC_ADD, "ccw"

    def release(self) -> None:
        """Release programs and spare textures."""
        self.release_spare_textures()
        for program in self._programs.values():
            program.release()
        self._programs.clear()


def read(texture: Any) -> np.ndarray:
    """Copy a float32 texture to an array, (H, W, components)."""
    width, height = texture.size
    return np.frombuffer(texture.read(), np.float32).reshape(height, width, texture.components)


@cache
def shared_device() -> Device:
    """Return the process's own device: what it compiled for one scene serves the next."""
    return Device(shared_context())
