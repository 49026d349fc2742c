"""Draws one scene with one technique, pass by pass."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from gpu_impl.device import Device, shared_device
from gpu_impl.frame import Frame
from gpu_impl.geometry import Geometry
from gpu_impl.lattice import Lattice
from gpu_impl.light_uniforms import placed
from gpu_impl.motion import moved
from gpu_impl.passes.combination import combine
from gpu_impl.passes.geometry import GBuffer, render_gbuffer
from gpu_impl.passes.scattering import COUNTERS, add_scattering
from gpu_impl.passes.shadow_buffer import in_buffer
from gpu_impl.passes.shadow_map import ShadowMap, check_map_size, render_shadow_map
from gpu_impl.passes.shadow_volume import render_shadow_polygons
from gpu_impl.passes.surface import add_surface
from gpu_impl.passes.tone_mapping import tone_map
from gpu_impl.silhouettes import Adjacency
from gpu_impl.techniques import Technique
from gpu_impl.textures import PictureTextures
from gpu_impl.timing import NO_CLOCK, Clock
from gpu_impl.visibilities import VISIBILITIES
from scenes.errors import InputError
from scenes.model import Scene


@dataclass(frozen=True)
class View:
    """What the eye and the lights see: the same for all techniques that share what `view_key` names."""

    gbuffer: GBuffer
    shadow_maps: tuple[ShadowMap, ...]
    surface: Any

    def give_back(self, device: Device) -> None:
        """Give the textures and buffers back."""
        device.give_back(*self.gbuffer.textures, self.surface, *(found.memory for found in self.shadow_maps))


def view_key(technique: Technique) -> tuple[object, ...]:
    """The settings of a technique that decide its `View`."""
    return technique.shadow_map, technique.shadow_storage, technique.surface_shadows, technique.composition


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
        self._clock: Clock = NO_CLOCK
        self._adjacency: Adjacency | None = None

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def release(self) -> None:
        """Give back what the scene holds on the GPU."""
        self._geometry.release()
        if self._adjacency:
            self._adjacency.release()
            self._adjacency = None
        self._pictures.release()
        for view in self._views.values():
            view.give_back(self.device)
        self._views.clear()
        self.device.release_spare_textures()

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

    def picture(self, technique: Technique, exposure: float = 1.0) -> np.ndarray:
        """Draw a frame for display; see `tone_map` for `exposure` and what is raised.

        Returns
        -------
        (H, W, 3) uint8
            sRGB, row 0 at the top.
        """
        technique.check()
        technique.check_scene(self.scene)
        composite = self._composite(technique)
        display = self.device.texture(composite.size, 4, "f1")
        try:
            tone_map(self.device, display, composite, exposure)
            return np.frombuffer(display.read(), np.uint8).reshape(display.height, display.width, 4)[..., :3]
        finally:
            self.device.give_back(composite, display)

    def milliseconds(self, technique: Technique, frames: int = 5) -> float:
        """Median of `frame_time`, after `render` has warmed the driver up."""
        return float(np.median([self.frame_time(technique, number) for number in range(frames)]))

    def frame_time(self, technique: Technique, number: int, clock: Clock = NO_CLOCK) -> float:
        """Draw frame `number` of a scene in which eye and lights move (see `moved`) as an application would show it.

        Parameters
        ----------
        clock : told of each pass, such as a `gpu_impl.timing.PassClock`

        Returns
        -------
        float
            Wall-clock time, all passes up to glFinish [ms].
        """
        still, context = (self.scene, self._lights), self.device.context
        self.scene = moved(self.scene, number, self._geometry.bounds)
        self._lights = tuple(placed(light, self._geometry.bounds) for light in self.scene.lights)
        self._clock = clock
        try:
            context.finish()
            begin = time.perf_counter()
            self._display(technique)
            context.finish()
            return 1e3 * (time.perf_counter() - begin)
        finally:
            (self.scene, self._lights), self._clock = still, NO_CLOCK

    def counts(self, technique: Technique) -> dict[str, np.ndarray]:
        """Count what the scattering pass does for each ray that it evaluates, all lights together.

        Returns
        -------
        dict
            Arrays (h, w) of every `technique.downsample`-th pixel by their names in `COUNTERS`: lit pieces handed to
            the airlight model, texels read from shadow maps, exponential integrals, and exponentials, a colour's
            counted as three.
        """
        technique.check()
        technique.check_scene(self.scene)
        view = self._see(technique)
        counts = self._lattice_texture(technique)
        airlight = self._scatter(technique, view, counts)
        found = _read(counts)
        self.device.give_back(airlight, counts)
        view.give_back(self.device)
        return {name: found[..., channel] for channel, name in enumerate(COUNTERS)}

    def _display(self, technique: Technique) -> None:
        """Draw a frame as an application would show it; nothing is kept from the one before or for the next."""
        self.device.give_back(self._composite(technique))

    def _composite(self, technique: Technique) -> Any:
        """Draw surfaces and fog together; the caller gives back the texture."""
        view = self._see(technique)
        airlight, composite = self._scatter(technique, view), self._full_size_texture()
        with self._clock.time_pass("combination"):
            combine(self.device, (composite,), technique, self.scene, view.gbuffer, view.surface, airlight)
        self.device.give_back(airlight)
        view.give_back(self.device)
        return composite

    def _see(self, technique: Technique) -> View:
        """Run the passes before the fog; the caller gives back the view."""
        device, scene = self.device, self.scene
        with self._clock.time_pass("geometry"):
            gbuffer = render_gbuffer(device, self._geometry, scene.camera, self._pictures)
        with self._clock.time_pass("shadow map"):
            shadow_maps = tuple(
                render_shadow_map(device, self._geometry, light, technique.shadow_map) for light in self._lights
            )
            if technique.shadow_storage == "buffer":
                shadow_maps = tuple(in_buffer(device, shadow_map) for shadow_map in shadow_maps)
        surface = self._full_size_texture()
        with self._clock.time_pass("surface"):
            for i, (light, shadow_map) in enumerate(zip(self._lights, shadow_maps, strict=True)):
                add_surface(
                    device,
                    surface,
                    technique,
                    scene,
                    light,
                    gbuffer,
                    shadow_map,
                    self._pictures,
                    first=i == 0,
                )
        return View(gbuffer, shadow_maps, surface)

    def _scatter(self, technique: Technique, view: View, counts: Any = None) -> Any:
        """Evaluate the fog on every N-th pixel, counting into a texture of that size; the caller gives the result back."""
        texture, polygons = self._lattice_texture(technique), self._shadow_polygons(technique, view)
        with self._clock.time_pass("scattering"):
            for i, (light, shadow_map) in enumerate(zip(self._lights, view.shadow_maps, strict=True)):
                add_scattering(
                    self.device,
                    texture,
                    technique,
                    self.scene,
                    light,
                    view.gbuffer,
                    shadow_map,
                    self._pictures,
                    polygons=polygons,
                    layer=i,
                    counts=counts,
                    first=i == 0,
                )
        if polygons:
            self.device.give_back(polygons)
        return texture

    def _shadow_polygons(self, technique: Technique, view: View) -> Any:
        """Draw the shadow polygons that the technique asks for, a texture that the caller gives back; None for none."""
        wanted = VISIBILITIES[technique.visibility].polygons
        if wanted is None:
            return None
        if self._adjacency is None:
            self._adjacency = Adjacency(self.device.context, self.scene)
        with self._clock.time_pass("shadow polygons"):
            return render_shadow_polygons(
                self.device,
                self._adjacency,
                self.scene,
                self._lights,
                view.gbuffer,
                view.shadow_maps,
                self._pictures,
                lattice=Lattice.of(self.scene.camera, technique.downsample),
                repaired=wanted == "repaired",
            )

    def _layers(self, technique: Technique, view: View) -> tuple[np.ndarray, np.ndarray]:
        """The surface's light as it reaches the eye and the airlight, each (H, W, 4)."""
        airlight = self._scatter(technique, view)
        layers = self._full_size_texture(), self._full_size_texture()
        combine(self.device, layers, technique, self.scene, view.gbuffer, view.surface, airlight)
        surface, scattering = (_read(layer) for layer in layers)
        self.device.give_back(airlight, *layers)
        return surface, scattering

    def _lattice_texture(self, technique: Technique) -> Any:
        return self.device.texture(Lattice.of(self.scene.camera, technique.downsample).size, 4)

    def _full_size_texture(self) -> Any:
        return self.device.texture((self.scene.camera.width, self.scene.camera.height), 4)


def _read(texture: Any) -> np.ndarray:
    """Copy a float texture to an array, (H, W, components)."""
    width, height = texture.size
    return np.frombuffer(texture.read(), np.float32).reshape(height, width, texture.components)
