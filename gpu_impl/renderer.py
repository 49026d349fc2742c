"""Draws one scene with one technique: shadow map, surface, scattering, upsampling."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from gpu_impl.context import gl_info, shared_context
from gpu_impl.frame import Frame
from gpu_impl.geometry import GBuffer, Geometry, camera_uniforms, render_gbuffer
from gpu_impl.quadrature_nodes import gauss_legendre_glsl
from gpu_impl.shader_source import ShaderSource, compile_program, set_uniforms
from gpu_impl.shadow_map import ShadowMap, render_shadow_map, tile_count
from gpu_impl.techniques import AIRLIGHT_MODELS, VISIBILITIES, Technique
from scenes.errors import InputError
from scenes.model import Light, Scene

QUADRATURE_NODES = 24
VERTEX = ShaderSource("fullscreen.vert.glsl")


class Renderer:
    """Holds one scene on the GPU and draws it with any technique.

    Use it as a context manager, or call `release`.
    """

    def __init__(self, scene: Scene, context: Any | None = None) -> None:
        self.scene = scene
        self.context = context or shared_context()
        widest = self.context.info["GL_MAX_TEXTURE_SIZE"]
        if max(scene.camera.width, scene.camera.height) > widest:
            raise InputError(f"The image is larger than this OpenGL allows ({widest} pixels on a side).")
        self._geometry = Geometry(self.context, scene)
        self._programs: dict[tuple, Any] = {}

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def release(self) -> None:
        """Give back what the scene holds on the GPU."""
        self._geometry.release()
        for program in self._programs.values():
            program.release()
        self._programs.clear()

    def render(self, technique: Technique) -> Frame:
        """Draw a frame twice, the second timed.

        Raises
        ------
        InputError
            The technique cannot take this scene.
        """
        technique.check()
        technique.check_phase(self.scene.phase)
        for _ in range(2):
            # the first frame compiles shaders and touches memory
            self.context.finish()
            begin = time.perf_counter()
            textures = self._draw(technique)
            self.context.finish()
            milliseconds = 1e3 * (time.perf_counter() - begin)
            surface, scattering, gbuffer = (_read(texture) for texture in textures)
            for texture in textures:
                texture.release()
        depth = np.where(gbuffer[..., 3] > 0, gbuffer[..., 3], self.scene.camera.rays()[2]).astype(np.float32)
        return Frame(
            surface=surface[..., :3],
            scattering=scattering[..., :3],
            depth=depth,
            lit_intervals=scattering[..., 3],
            technique=technique,
            gl=gl_info(self.context),
            milliseconds=milliseconds,
        )

    def _draw(self, technique: Technique) -> tuple[Any, Any, Any]:
        camera, step = self.scene.camera, technique.downsample
        full = (camera.width, camera.height)
        gbuffer = render_gbuffer(self.context, self._geometry, camera)
        surface = self.context.texture(full, 4, dtype="f4")
        coarse = self.context.texture(tuple(-(-side // step) for side in full), 4, dtype="f4")
        for number, light in enumerate(self.scene.lights):
            shadow_map = render_shadow_map(self.context, self._geometry, light, technique.shadow_map)
            self._add_light(self._surface_program(light), surface, gbuffer, light, shadow_map, number == 0, {})
            program = self._scattering_program(technique, light)
            self._add_light(program, coarse, gbuffer, light, shadow_map, number == 0, {"downsample": step})
            shadow_map.texture.release()
        gbuffer.material.release()
        if step == 1:
            return surface, coarse, gbuffer.normal_and_distance
        fine = self._upsample(coarse, gbuffer, step)
        coarse.release()
        return surface, fine, gbuffer.normal_and_distance

    def _add_light(
        self,
        program: Any,
        texture: Any,
        gbuffer: GBuffer,
        light: Light,
        shadow_map: ShadowMap,
        is_first: bool,
        more: dict[str, Any],
    ) -> None:
        """Run a full-screen pass for one light, added to those before it."""
        gbuffer.normal_and_distance.use(1)
        gbuffer.material.use(2)
        uniforms = {
            **camera_uniforms(self.scene.camera),
            **shadow_map.uniforms(unit=0),
            "normal_and_distance": 1,
            "surface_material": 2,
            "sigma_s": tuple(np.broadcast_to(self.scene.medium.sigma_s, 3).tolist()),
            "sigma_t": tuple(np.broadcast_to(self.scene.medium.sigma_t, 3).tolist()),
            "g": getattr(self.scene.phase, "g", 0.0),
            "light.position": tuple(light.position),
            "light.direction": tuple(light.direction),
            "light.intensity": tuple(light.intensity),
            "light.beam_width": light.beam_width,
            "light.cutoff_angle": light.cutoff_angle,
        }
        set_uniforms(program, uniforms | more)
        if not is_first:
            self.context.enable(self.context.BLEND)
            self.context.blend_func = self.context.ONE, self.context.ONE
        self._fill(program, texture)
        self.context.disable(self.context.BLEND)

    def _upsample(self, coarse: Any, gbuffer: GBuffer, step: int) -> Any:
        camera = self.scene.camera
        fine = self.context.texture((camera.width, camera.height), 4, dtype="f4")
        coarse.use(0)
        gbuffer.normal_and_distance.use(1)
        program = self._program(("upsample",), lambda: ShaderSource("upsample.frag.glsl"))
        uniforms = {"scattering": 0, "normal_and_distance": 1, "downsample": step}
        set_uniforms(program, uniforms | {"image_size": (camera.width, camera.height)})
        self._fill(program, fine)
        return fine

    def _fill(self, program: Any, texture: Any) -> None:
        target = self.context.framebuffer(color_attachments=[texture])
        target.use()
        array = self.context.vertex_array(program, [])
        array.render(vertices=3)
        array.release()
        target.release()

    def _surface_program(self, light: Light) -> Any:
        defines = {"GREY": 1, "TILES": tile_count(light)}
        return self._program(("surface", *defines.values()), lambda: ShaderSource("surface.frag.glsl", defines))

    def _scattering_program(self, technique: Technique, light: Light) -> Any:
        grey = np.ptp(np.broadcast_to(self.scene.medium.sigma_t, 3)) == 0
        defines = {"GREY": int(grey), "TILES": tile_count(light), "STEPS": technique.steps}
        includes = {
            "<airlight>": AIRLIGHT_MODELS[technique.airlight].source,
            "<visibility>": VISIBILITIES[technique.visibility].source,
            "<phase>": f"phase/{self.scene.phase.name}.glsl",
        }
        return self._program(
            (*defines.values(), *includes.values()),
            lambda: ShaderSource("scattering.frag.glsl", defines, includes, generated_includes()),
        )

    def _program(self, key: tuple, source: Any) -> Any:
        if key not in self._programs:
            self._programs[key] = compile_program(self.context, VERTEX, source())
        return self._programs[key]


def generated_includes() -> dict[str, str]:
    """Texts of the includes that are computed rather than written."""
    return {"<gauss-legendre>": gauss_legendre_glsl(QUADRATURE_NODES)}


def _read(texture: Any) -> np.ndarray:
    """Copy a float texture to an array, (H, W, components)."""
    width, height = texture.size
    return np.frombuffer(texture.read(), np.float32).reshape(height, width, texture.components)
