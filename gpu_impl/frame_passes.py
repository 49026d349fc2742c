"""The passes of a frame, run in their order: Weng 2010, Figure 1.3."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gpu_impl.camera_uniforms import camera_uniforms
from gpu_impl.device import Device, read
from gpu_impl.geometry import Geometry
from gpu_impl.given import Finder, GivenIntervals, find_none
from gpu_impl.lattices import LATTICES, Lattice
from gpu_impl.light_uniforms import light_defines, light_uniforms, placed
from gpu_impl.passes.combination import combine, reconstruct
from gpu_impl.passes.geometry import GBuffer, render_gbuffer
from gpu_impl.passes.scattering import add_scattering
from gpu_impl.passes.shadow_buffer import in_buffer
from gpu_impl.passes.shadow_map import ShadowMap, render_shadow_map
from gpu_impl.passes.surface import add_surface
from gpu_impl.shader_source import set_uniforms
from gpu_impl.techniques import Technique
from gpu_impl.textures import PictureTextures
from gpu_impl.timing import NO_CLOCK, Clock
from gpu_impl.visibilities import VISIBILITIES
from gpu_impl.visibilities.strategy import FogInputs, Kept
from scenes.model import Scene


@dataclass(frozen=True)
class View:
    """What the eye and the lights see: the same for all techniques that share what `view_key` names."""

    gbuffer: GBuffer
    shadow_maps: tuple[ShadowMap, ...]
    surface: Any

    @property
    def memory(self) -> tuple[Any, ...]:
        """Its textures and buffers."""
        return *self.gbuffer.textures, self.surface, *(found.memory for found in self.shadow_maps)

    def give_back(self, device: Device) -> None:
        """Give the textures and buffers back."""
        device.give_back(*self.memory)


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

    def __init__(self, device: Device, scene: Scene, find_lit: Finder = find_none) -> None:
        self.device = device
        self.kept = Kept()
        self._find_lit = find_lit
        self._given: dict[tuple[object, ...], GivenIntervals] = {}
        self.geometry = Geometry(device, scene)
        self.pictures = PictureTextures(device)
        self.clock: Clock = NO_CLOCK
        self.look(scene)

    def look(self, scene: Scene) -> None:
        """Take another eye and other lights; the meshes are to be the same."""
        self._forget_given()
        self.scene = scene
        self.lights = tuple(placed(light, self.geometry.bounds) for light in scene.lights)

    def release(self) -> None:
        """Give back what the scene holds on the GPU."""
        self.geometry.release()
        self.pictures.release()
        self.kept.release()
        self._forget_given()

    def _forget_given(self) -> None:
        for given in self._given.values():
            given.release()
        self._given.clear()

    def composite(self, technique: Technique) -> Any:
        """Draw surfaces and fog together; the caller gives back the texture."""
        view = self.see(technique)
        airlight, composite = self.scatter(technique, view), self._full_size_texture()
        with self.clock.time_pass("combination"):
            self.combine((composite,), technique, view, airlight)
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

    def scatter(self, technique: Technique, view: View) -> Any:
        """Evaluate the fog; the caller gives the result back.

        Returns
        -------
        texture RGBA32F
            Airlight and pieces on the grid's cells, all lights together. Another lattice is each light's own, and the
            texture is at full resolution then.
        """
        if technique.lattice == "grid":
            texture = self.lattice_texture(technique)
            for i in range(len(self.lights)):
                self.scatter_light(texture, technique, view, i, first=i == 0)
            return texture
        whole = self._full_size_texture()
        for i in range(len(self.lights)):
            texture = self.lattice_texture(technique)
            self.scatter_light(texture, technique, view, i, first=True)
            self.reconstruct(whole, technique, view, i, texture)
            self.device.give_back(texture)
        return whole

    def reconstruct(self, target: Any, technique: Technique, view: View, number: int, airlight: Any) -> None:
        """Bring a light's airlight to full resolution from its own lattice, and add it to the lights' before."""
        lattice = self.lattice(technique, number)
        with self.clock.time_pass("combination"):
            reconstruct(self.device, target, lattice, self.scene, view.gbuffer, airlight, first=number == 0)

    def scatter_light(self, target: Any, technique: Technique, view: View, number: int, **asked: Any) -> None:
        """Evaluate one light's fog on its lattice; see `add_scattering` for what else can be asked."""
        inputs = self.inputs(technique, view, number)
        supply = VISIBILITIES[technique.visibility].supply(inputs)
        with self.clock.time_pass("scattering"):
            add_scattering(target, inputs, supply, **asked)
        supply.give_back(self.device)

    def lattice(self, technique: Technique, number: int) -> Lattice:
        """Lay a technique's lattice over the picture for one light."""
        return Lattice.of(LATTICES[technique.lattice], self.scene, self.lights[number], technique.downsample)

    def rays(self, technique: Technique, view: View, number: int) -> np.ndarray:
        """Find which rays the lattice evaluates: see shaders/lattice_rays.frag.glsl, (h, w, 4)."""
        light, lattice = self.lights[number], self.lattice(technique, number)
        program = self.device.program(
            "lattice_rays.frag.glsl",
            defines=light_defines(self.scene, light),
            includes={"<lattice>": lattice.kind.source},
        )
        set_uniforms(program, camera_uniforms(self.scene.camera) | light_uniforms(self.scene, light, self.pictures))
        set_uniforms(program, lattice.uniforms | view.gbuffer.bind(first_unit=1))
        texture = self.lattice_texture(technique)
        self.device.fill(program, texture)
        found = read(texture)
        self.device.give_back(texture)
        return found

    def inputs(self, technique: Technique, view: View, number: int) -> FogInputs:
        """Gather what a visibility strategy may build on for one light."""
        return FogInputs(
            self.device,
            self.scene,
            self.lights[number],
            number,
            technique,
            self.lattice(technique, number),
            self.geometry,
            view.gbuffer,
            view.shadow_maps[number],
            self.pictures,
            self.kept,
            self.given(technique, view, number) if technique.asks_rays else None,
            self.clock,
        )

    def given(self, technique: Technique, view: View, number: int) -> GivenIntervals:
        """Ask for the lit intervals of the lattice's rays, once for this eye and this light."""
        key = technique.lattice, technique.downsample, number
        if key not in self._given:
            rays = self.rays(technique, view, number).astype(np.float64)
            # past its beginning, where there is fog
            ends = rays[..., 2] + np.maximum(rays[..., 3], 0)
            found = self._find_lit(self.scene, number, rays[..., :2], ends)
            self._given[key] = GivenIntervals(self.device, found, rays.shape[1::-1])
        return self._given[key]

    def layers(self, technique: Technique, view: View) -> tuple[Any, Any]:
        """Draw the surface's light as it reaches the eye, and the airlight; the caller gives both back."""
        airlight = self.scatter(technique, view)
        layers = self._full_size_texture(), self._full_size_texture()
        self.combine(layers, technique, view, airlight)
        self.device.give_back(airlight)
        return layers

    def lattice_texture(self, technique: Technique) -> Any:
        """Take a texture with a pixel for each ray on which the fog is evaluated."""
        size = LATTICES[technique.lattice].size(self.scene.camera, technique.downsample)
        return self.device.texture(size, 4)

    def combine(self, targets: tuple[Any, ...], technique: Technique, view: View, airlight: Any) -> None:
        """Put surface and what `scatter` returned together; see `passes.combination.combine` for the targets."""
        step = technique.downsample if technique.lattice == "grid" else 1
        combine(self.device, targets, technique, self.scene, view.gbuffer, view.surface, airlight, step)

    def _full_size_texture(self) -> Any:
        return self.device.texture((self.scene.camera.width, self.scene.camera.height), 4)
