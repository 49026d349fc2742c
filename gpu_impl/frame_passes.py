"""The passes of a frame, run in their order: Weng 2010, Figure 1.3."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from gpu_impl.device import Device
from gpu_impl.geometry import Geometry
from gpu_impl.lattice import Lattice
from gpu_impl.light_uniforms import placed
from gpu_impl.passes.combination import combine
from gpu_impl.passes.geometry import GBuffer, render_gbuffer
from gpu_impl.passes.scattering import add_scattering
from gpu_impl.passes.shadow_buffer import in_buffer
from gpu_impl.passes.shadow_map import ShadowMap, render_shadow_map
from gpu_impl.passes.shadow_volume import render_shadow_polygons
from gpu_impl.passes.surface import add_surface
from gpu_impl.silhouettes import Adjacency
from gpu_impl.techniques import Technique
from gpu_impl.textures import PictureTextures
from gpu_impl.timing import NO_CLOCK, Clock
from gpu_impl.visibilities import VISIBILITIES
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


class FramePasses:
    """Holds a scene's meshes and pictures on the GPU and runs the passes on them.

    Attributes
    ----------
    scene : Scene      whose eye and lights are drawn; `look` takes others
    lights : tuple     as the passes have them: a directional light has a position
    clock : Clock      told of each pass
    """

    def __init__(self, device: Device, scene: Scene) -> None:
        self.device = device
        self.geometry = Geometry(device, scene)
        self.pictures = PictureTextures(device)
        self.clock: Clock = NO_CLOCK
        self._adjacency: Adjacency | None = None
        self.look(scene)

    def look(self, scene: Scene) -> None:
        """Take another eye and other lights; the meshes are to be the same."""
        self.scene = scene
        self.lights = tuple(placed(light, self.geometry.bounds) for light in scene.lights)

    def release(self) -> None:
        """Give back what the scene holds on the GPU."""
        self.geometry.release()
        self.pictures.release()
        if self._adjacency is not None:
            self._adjacency.release()

    def composite(self, technique: Technique) -> Any:
        """Draw surfaces and fog together; the caller gives back the texture."""
        view = self.see(technique)
        airlight, composite = self.scatter(technique, view), self._full_size_texture()
        with self.clock.time_pass("combination"):
            combine(self.device, (composite,), technique, self.scene, view.gbuffer, view.surface, airlight)
        self.device.give_back(airlight)
        view.give_back(self.device)
        return composite

    def see(self, technique: Technique) -> View:
        """Run the passes before the fog; the caller gives back the view."""
        device, scene = self.device, self.scene
        with self.clock.time_pass("geometry"):
            gbuffer = render_gbuffer(device, self.geometry, scene.camera, self.pictures)
        with self.clock.time_pass("shadow map"):
            shadow_maps = tuple(
                render_shadow_map(device, self.geometry, light, technique.shadow_map) for light in self.lights
            )
            if technique.shadow_storage == "buffer":
                shadow_maps = tuple(in_buffer(device, shadow_map) for shadow_map in shadow_maps)
        surface = self._full_size_texture()
        with self.clock.time_pass("surface"):
            for i, (light, shadow_map) in enumerate(zip(self.lights, shadow_maps, strict=True)):
                add_surface(
                    device,
                    surface,
                    technique,
                    scene,
                    light,
                    gbuffer,
                    shadow_map,
                    self.pictures,
                    first=i == 0,
                )
        return View(gbuffer, shadow_maps, surface)

    def scatter(self, technique: Technique, view: View, counts: Any = None) -> Any:
        """Evaluate the fog on the lattice, counting into a texture of its size; the caller gives the result back."""
        texture, polygons = self.lattice_texture(technique), self.shadow_polygons(technique, view)
        with self.clock.time_pass("scattering"):
            for i, (light, shadow_map) in enumerate(zip(self.lights, view.shadow_maps, strict=True)):
                add_scattering(
                    self.device,
                    texture,
                    technique,
                    self.scene,
                    light,
                    view.gbuffer,
                    shadow_map,
                    self.pictures,
                    polygons=polygons,
                    layer=i,
                    counts=counts,
                    first=i == 0,
                )
        if polygons:
            self.device.give_back(polygons)
        return texture

    def shadow_polygons(self, technique: Technique, view: View) -> Any:
        """Draw the shadow polygons that the technique asks for, a texture that the caller gives back; None for none."""
        wanted = VISIBILITIES[technique.visibility].polygons
        if wanted is None:
            return None
        if self._adjacency is None:
            self._adjacency = Adjacency(self.device.context, self.scene)
        with self.clock.time_pass("shadow polygons"):
            return render_shadow_polygons(
                self.device,
                self._adjacency,
                self.scene,
                self.lights,
                view.gbuffer,
                view.shadow_maps,
                self.pictures,
                lattice=Lattice.of(self.scene.camera, technique.downsample),
                repaired=wanted == "repaired",
            )

    def layers(self, technique: Technique, view: View) -> tuple[Any, Any]:
        """Draw the surface's light as it reaches the eye, and the airlight; the caller gives both back."""
        airlight = self.scatter(technique, view)
        layers = self._full_size_texture(), self._full_size_texture()
        combine(self.device, layers, technique, self.scene, view.gbuffer, view.surface, airlight)
        self.device.give_back(airlight)
        return layers

    def lattice_texture(self, technique: Technique) -> Any:
        """Take a texture with a pixel for each ray on which the fog is evaluated."""
        return self.device.texture(Lattice.of(self.scene.camera, technique.downsample).size, 4)

    def _full_size_texture(self) -> Any:
        return self.device.texture((self.scene.camera.width, self.scene.camera.height), 4)
