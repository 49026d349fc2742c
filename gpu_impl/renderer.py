"""Draws one scene with one technique: shadow map, surface, scattering, upsampling."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from gpu_impl.device import Device, shared_device
from gpu_impl.frame import Frame
from gpu_impl.geometry import Geometry, render_gbuffer
from gpu_impl.scattering import add_scattering
from gpu_impl.shadow_map import check_map_size, render_shadow_map
from gpu_impl.surface import add_surface
from gpu_impl.techniques import Technique
from gpu_impl.upsample import upsample
from scenes.errors import InputError
from scenes.model import Scene


class Renderer:
    """Holds one scene on the GPU and draws it with any technique.

    Use it as a context manager, or call `release`.
    """

    def __init__(self, scene: Scene, device: Device | None = None) -> None:
        self.scene = scene
        self.device = device or shared_device()
        if max(scene.camera.width, scene.camera.height) > self.device.largest_texture:
            limit = self.device.largest_texture
            raise InputError(f"The image is larger than this OpenGL allows ({limit} pixels on a side).")
        self._geometry = Geometry(self.device, scene)

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def release(self) -> None:
        """Give back what the scene holds on the GPU."""
        self._geometry.release()

    def render(self, technique: Technique) -> Frame:
        """Draw a frame.

        Raises
        ------
        InputError
            The technique cannot take this scene.
        """
        technique.check()
        technique.check_phase(self.scene.phase)
        for light in self.scene.lights:
            check_map_size(self.device, light, technique.shadow_map)
        textures = self._draw(technique)
        surface, scattering, gbuffer = (_read(texture) for texture in textures)
        for texture in textures:
            texture.release()
        if not (np.isfinite(surface).all() and np.isfinite(scattering).all()):
            raise InputError(f"{technique.name} draws {self.scene.path} with pixels that are not finite.")
        far = self.scene.camera.rays()[2]
        return Frame(
            surface=surface[..., :3],
            scattering=scattering[..., :3],
            depth=np.where(gbuffer[..., 3] > 0, gbuffer[..., 3], far).astype(np.float32),
            lit_intervals=scattering[..., 3],
            technique=technique,
            gl=self.device.info,
        )

    def milliseconds(self, technique: Technique, frames: int = 5) -> float:
        """Median wall-clock time of a frame, all passes up to glFinish, after `render` has warmed the driver up."""
        times = []
        for _ in range(frames):
            self.device.context.finish()
            begin = time.perf_counter()
            textures = self._draw(technique)
            self.device.context.finish()
            times.append(1e3 * (time.perf_counter() - begin))
            for texture in textures:
                texture.release()
        return float(np.median(times))

    def _draw(self, technique: Technique) -> tuple[Any, Any, Any]:
        """Run all passes; returns the textures of surface, scattering and G-buffer, to be given back by the caller."""
        device, scene, step = self.device, self.scene, technique.downsample
        camera = scene.camera
        gbuffer = render_gbuffer(device, self._geometry, camera)
        surface = device.texture((camera.width, camera.height), 4)
        scattering = device.texture((-(-camera.width // step), -(-camera.height // step)), 4)
        for texture in (surface, scattering):
            device.clear(texture)
        for light in scene.lights:
            shadow_map = render_shadow_map(device, self._geometry, light, technique.shadow_map)
            add_surface(device, surface, scene, light, gbuffer, shadow_map)
            add_scattering(device, scattering, technique, scene, light, gbuffer, shadow_map)
            shadow_map.texture.release()
        if step > 1:
            scattering = upsample(device, scattering, camera, gbuffer, step)
        gbuffer.material.release()
        gbuffer.triangle_normal.release()
        return surface, scattering, gbuffer.normal_and_distance


def _read(texture: Any) -> np.ndarray:
    """Copy a float texture to an array, (H, W, components)."""
    width, height = texture.size
    return np.frombuffer(texture.read(), np.float32).reshape(height, width, texture.components)
