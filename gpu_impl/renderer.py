"""Draws one scene with one technique, pass by pass."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from gpu_impl.device import Device, shared_device
from gpu_impl.frame import Frame
from gpu_impl.geometry import Geometry
from gpu_impl.light_uniforms import placed
from gpu_impl.passes.combination import combine
from gpu_impl.passes.geometry import GBuffer, render_gbuffer
from gpu_impl.passes.scattering import add_scattering
from gpu_impl.passes.shadow_map import ShadowMap, check_map_size, render_shadow_map
from gpu_impl.passes.surface import add_surface
from gpu_impl.techniques import Technique
from gpu_impl.textures import PictureTextures
from scenes.errors import InputError
from scenes.model import Scene


@dataclass(frozen=True)
class View:
    """What the eye and the lights see: the same for all techniques that share what `view_key` names."""

    gbuffer: GBuffer
    shadow_maps: tuple[ShadowMap, ...]
    surface: Any

    def release(self) -> None:
        """Give the textures back."""
        for texture in (*self.gbuffer.textures, self.surface, *(found.texture for found in self.shadow_maps)):
            texture.release()


def view_key(technique: Technique) -> tuple[object, ...]:
    """The settings of a technique that decide its `View`."""
    return technique.shadow_map, technique.composition


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
        self._views: dict[tuple[object, ...], View] = {}

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
            key = view_key(technique)
            if key not in self._views:
                self._views[key] = self._see(technique)
            view = self._views[key]
            surface, scattering = self._layers(technique, view)
        except moderngl.Error as error:
            camera = self.scene.camera
            raise InputError(
                f"OpenGL cannot draw {camera.width} x {camera.height} pixels with {technique.shadow_map} texels of "
                f"shadow map ({' '.join(str(error).split())}): make one of them smaller."
            ) from None
        gbuffer = _read(view.gbuffer.normal_and_distance)
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
            self._display(technique)
            self.device.context.finish()
            times.append(1e3 * (time.perf_counter() - begin))
        return float(np.median(times))

    def _display(self, technique: Technique) -> None:
        """Draw a frame as an application would show it; nothing is kept from the one before or for the next."""
        view = self._see(technique)
        airlight, composite = self._scatter(technique, view), self._full_size_texture()
        combine(self.device, (composite,), technique, self.scene, view.gbuffer, view.surface, airlight)
        for texture in (airlight, composite, view):
            texture.release()

    def _see(self, technique: Technique) -> View:
        """Run the passes before the fog; the caller releases the view."""
        device, scene = self.device, self.scene
        gbuffer = render_gbuffer(device, self._geometry, scene.camera, self._pictures)
        shadow_maps = tuple(
            render_shadow_map(device, self._geometry, light, technique.shadow_map) for light in self._lights
        )
        surface = self._full_size_texture()
        for i, (light, shadow_map) in enumerate(zip(self._lights, shadow_maps, strict=True)):
            add_surface(
                device,
                surface,
                scene,
                light,
                gbuffer,
                shadow_map,
                self._pictures,
                composition=technique.composition,
                first=i == 0,
            )
        return View(gbuffer, shadow_maps, surface)

    def _scatter(self, technique: Technique, view: View) -> Any:
        """Evaluate the fog on every N-th pixel; the caller releases the texture."""
        device, scene, step = self.device, self.scene, technique.downsample
        texture = device.texture((-(-scene.camera.width // step), -(-scene.camera.height // step)), 4)
        for i, (light, shadow_map) in enumerate(zip(self._lights, view.shadow_maps, strict=True)):
            add_scattering(
                device, texture, technique, scene, light, view.gbuffer, shadow_map, self._pictures, first=i == 0
            )
        return texture

    def _layers(self, technique: Technique, view: View) -> tuple[np.ndarray, np.ndarray]:
        """The surface's light as it reaches the eye and the airlight, each (H, W, 4)."""
        airlight = self._scatter(technique, view)
        layers = self._full_size_texture(), self._full_size_texture()
        combine(self.device, layers, technique, self.scene, view.gbuffer, view.surface, airlight)
        surface, scattering = (_read(layer) for layer in layers)
        for texture in (airlight, *layers):
            texture.release()
        return surface, scattering

    def _full_size_texture(self) -> Any:
        return self.device.texture((self.scene.camera.width, self.scene.camera.height), 4)


def _read(texture: Any) -> np.ndarray:
    """Copy a float texture to an array, (H, W, components)."""
    width, height = texture.size
    return np.frombuffer(texture.read(), np.float32).reshape(height, width, texture.components)
