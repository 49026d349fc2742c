"""Draws one scene with one technique: shadow map, surface, scattering, upsampling."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from gpu_impl.device import Device, shared_device
from gpu_impl.frame import Frame
from gpu_impl.geometry import Geometry
from gpu_impl.light_uniforms import placed
from gpu_impl.passes.geometry import GBuffer, render_gbuffer
from gpu_impl.passes.scattering import add_scattering
from gpu_impl.passes.shadow_map import ShadowMap, check_map_size, render_shadow_map
from gpu_impl.passes.surface import add_surface
from gpu_impl.passes.upsampling import upsample
from gpu_impl.techniques import Technique
from gpu_impl.textures import PictureTextures
from scenes.errors import InputError
from scenes.model import Scene


@dataclass(frozen=True)
class View:
    """What the eye and the lights see, before any technique: the same for all that share a shadow-map size."""

    gbuffer: GBuffer
    surface: Any
    shadow_maps: tuple[ShadowMap, ...]

    def release(self) -> None:
        """Give the textures back."""
        for texture in (*self.gbuffer.textures, self.surface, *(found.texture for found in self.shadow_maps)):
            texture.release()


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
        self._pictures = PictureTextures(self.device)
        self._lights = tuple(placed(light, self._geometry.bounds) for light in scene.lights)
        self._views: dict[int, View] = {}

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def release(self) -> None:
        """Give back what the scene holds on the GPU."""
        self._geometry.release()
        self._pictures.release()
        for view in self._views.values():
            view.release()
        self._views.clear()

    def render(self, technique: Technique) -> Frame:
        """Draw a frame; its view is kept for other techniques.

        Raises
        ------
        InputError
            The technique cannot take this scene.
        """
        import moderngl

        technique.check()
        technique.check_scene(self.scene)
        for light in self.scene.lights:
            check_map_size(self.device, light, technique.shadow_map)
        try:
            if technique.shadow_map not in self._views:
                self._views[technique.shadow_map] = self._see(technique.shadow_map)
            view = self._views[technique.shadow_map]
            texture = self._scatter(technique, view)
        except moderngl.Error as error:
            camera = self.scene.camera
            raise InputError(
                f"OpenGL cannot draw {camera.width} x {camera.height} pixels with {technique.shadow_map} texels of "
                f"shadow map ({' '.join(str(error).split())}): make one of them smaller."
            ) from None
        surface, scattering, gbuffer = (_read(t) for t in (view.surface, texture, view.gbuffer.normal_and_distance))
        texture.release()
        if not (np.isfinite(surface).all() and np.isfinite(scattering).all()):
            raise InputError(
                f"{technique.name} draws {self.scene.path} with pixels that are not finite: bring its intensities, "
                "lengths and coefficients nearer to 1."
            )
        far = self.scene.camera.rays()[2]
        return Frame(
            surface=surface[..., :3],
            scattering=scattering[..., :3],
            depth=np.where(gbuffer[..., 3] > 0, gbuffer[..., 3], far).astype(np.float32),
            lit_intervals=scattering[..., 3],
            technique=technique,
            gl=self.device.info,
            scene_digest=self.scene.digest,
        )

    def milliseconds(self, technique: Technique, frames: int = 5) -> float:
        """Median wall-clock time of a frame, all passes up to glFinish, after `render` has warmed the driver up."""
        times = []
        for _ in range(frames):
            self.device.context.finish()
            begin = time.perf_counter()
            # camera and lights may have moved: nothing is kept from the frame before
            view = self._see(technique.shadow_map)
            texture = self._scatter(technique, view)
            self.device.context.finish()
            times.append(1e3 * (time.perf_counter() - begin))
            texture.release()
            view.release()
        return float(np.median(times))

    def _see(self, shadow_map_size: int) -> View:
        """Run the passes that no technique changes; the caller releases the view."""
        device, scene = self.device, self.scene
        gbuffer = render_gbuffer(device, self._geometry, scene.camera, self._pictures)
        surface = device.texture((scene.camera.width, scene.camera.height), 4)
        device.clear(surface)
        shadow_maps = tuple(render_shadow_map(device, self._geometry, light, shadow_map_size) for light in self._lights)
        for light, shadow_map in zip(self._lights, shadow_maps, strict=True):
            add_surface(device, surface, scene, light, gbuffer, shadow_map, self._pictures)
        return View(gbuffer, surface, shadow_maps)

    def _scatter(self, technique: Technique, view: View) -> Any:
        """Run the technique's own passes; the caller releases the texture."""
        device, scene, step = self.device, self.scene, technique.downsample
        texture = device.texture((-(-scene.camera.width // step), -(-scene.camera.height // step)), 4)
        device.clear(texture)
        for light, shadow_map in zip(self._lights, view.shadow_maps, strict=True):
            add_scattering(device, texture, technique, scene, light, view.gbuffer, shadow_map, self._pictures)
        return upsample(device, texture, scene.camera, view.gbuffer, step) if step > 1 else texture


def _read(texture: Any) -> np.ndarray:
    """Copy a float texture to an array, (H, W, components)."""
    width, height = texture.size
    return np.frombuffer(texture.read(), np.float32).reshape(height, width, texture.components)
