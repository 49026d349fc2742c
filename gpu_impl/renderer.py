"""Draws one scene with any technique, as a picture with its layers, for display, timed, or counted."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from typing import Any

import numpy as np

from gpu_impl.device import Device, read, shared_device
from gpu_impl.frame import Frame
from gpu_impl.frame_passes import FramePasses, View, view_key
from gpu_impl.given import Finder, find_none
from gpu_impl.motion import moved
from gpu_impl.passes.scattering import COUNTERS, OF_MODELS
from gpu_impl.passes.shadow_map import check_map_size
from gpu_impl.passes.tone_mapping import tone_map
from gpu_impl.recording import Pieces, Recording
from gpu_impl.techniques import Technique
from gpu_impl.timing import NO_CLOCK, Clock
from gpu_impl.visibilities import VISIBILITIES
from scenes.errors import InputError
from scenes.model import Scene


class Renderer:
    """Holds one scene on the GPU and draws it with any technique.

    Use it as a context manager, or call `release`.

    Parameters
    ----------
    device : Device     the process's own by default
    find_lit : Finder   casts rays for techniques that ask for them
    """

    def __init__(self, scene: Scene, device: Device | None = None, find_lit: Finder = find_none) -> None:
        self.scene = scene
        self.device = device or shared_device()
        if max(scene.camera.width, scene.camera.height) > self.device.largest_texture:
            limit = self.device.largest_texture
            raise InputError(f"The image is larger than this OpenGL allows ({limit} pixels on a side).")
        self.passes = FramePasses(self.device, scene, find_lit)
        self._views: dict[tuple[object, ...], View] = {}

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def release(self) -> None:
        """Give back what the scene holds on the GPU."""
        self.passes.release()
        self._forget_views()
        self.device.release_spare_textures()

    def _forget_views(self) -> None:
        for view in self._views.values():
            view.give_back(self.device)
        self._views.clear()

    def look(self, scene: Scene) -> None:
        """Take another eye or other lights; meshes and the picture's size are to be the same."""
        if scene is not self.scene:
            self._forget_views()
            self.scene = scene
            self.passes.look(scene)

    def render(self, technique: Technique) -> Frame:
        """Draw a frame; its view is kept for other techniques.

        Raises
        ------
        InputError
            The technique cannot take this scene, or OpenGL not so large a picture; so do the other methods.
        """
        with self._drawing(technique):
            key = view_key(technique)
            if key not in self._views:
                seen = self.passes.see(technique)
                self.device.keep(*seen.memory)
                self._views[key] = seen
            view = self._views[key]
            layers = self.passes.layers(technique, view)
            surface, scattering, gbuffer = (read(texture) for texture in (*layers, view.gbuffer.normal_and_distance))
            self.device.give_back(*layers)
        self._check_turns(technique, scattering)
        if not (np.isfinite(surface).all() and np.isfinite(scattering).all()):
            other = "" if technique.airlight == "quadrature" else f"use {technique.with_quadrature}, or "
            raise InputError(
                f"{technique.name} draws {self.scene.path} with pixels that are not finite: {other}bring "
                "the scene's intensities, lengths and coefficients nearer to 1."
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
        with self._drawing(technique):
            composite = self.passes.composite(technique)
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
        if technique.asks_rays:
            raise InputError(f"{technique.name} is told by ray casting what is lit, so that its time means nothing.")
        with self._drawing(technique):
            self.passes.look(moved(self.scene, number, self.passes.geometry.bounds))
            self.passes.clock = clock
            try:
                self.device.context.finish()
                begin = time.perf_counter()
                self.device.give_back(self.passes.composite(technique))
                self.device.context.finish()
                return 1e3 * (time.perf_counter() - begin)
            finally:
                self.passes.look(self.scene)
                self.passes.clock = NO_CLOCK

    def counts(self, technique: Technique) -> dict[str, np.ndarray]:
        """Count what the scattering pass does for each ray that it evaluates, all lights together.

        Returns
        -------
        dict
            Arrays (h, w) of the lattice's cells by their names in `COUNTERS`: lit pieces handed to the airlight model,
            texels read from shadow maps, exponential integrals, and exponentials, a colour's counted as three. Work of
            the passes before is not counted, such as that on an epipolar row's tree or a slice's corners; where the
            airlight model runs at corners alone, its integrals and exponentials are not a number.
        """
        with self._drawing(technique):
            view, airlight, counts = self.passes.see(technique), *self._lattice_textures(technique, 2)
            of_lights = []
            for number in range(len(self.passes.lights)):
                self.passes.scatter_light(airlight, technique, view, number, counts=counts, first=True)
                of_lights.append(read(counts))
            self.device.give_back(airlight, counts)
            view.give_back(self.device)
        found = dict(zip(COUNTERS, np.moveaxis(np.sum(of_lights, axis=0), -1, 0), strict=True))
        if VISIBILITIES[technique.visibility].airlight_at_corners:
            found |= {name: np.full_like(found[name], np.nan) for name in OF_MODELS}
        return found

    def record(self, technique: Technique) -> list[Pieces]:
        """Find what the technique calls lit, for each light: the pieces that it hands to its airlight model.

        Raises
        ------
        InputError
            Besides what the other methods raise: its airlight is interpolated between corners.
        """
        if VISIBILITIES[technique.visibility].airlight_at_corners:
            raise InputError(
                f"{technique.name} interpolates airlight between corners: its pieces alone do not make it."
            )
        found = []
        with self._drawing(technique):
            view, (airlight,) = self.passes.see(technique), self._lattice_textures(technique, 1)
            for number in range(len(self.passes.lights)):
                # How many there are is known from a first pass, by the same program: another build's fused products
                # may tear a piece in two.
                with closing(Recording(self.device.context, 0, airlight.width)) as counting:
                    self.passes.scatter_light(airlight, technique, view, number, recording=counting, first=True)
                    room = counting.reported
                with closing(Recording(self.device.context, room, airlight.width)) as recording:
                    self.passes.scatter_light(airlight, technique, view, number, recording=recording, first=True)
                    self._check_turns(technique, read(airlight))
                    found.append(recording.read(self.passes.rays(technique, view, number)))
            self.device.give_back(airlight)
            view.give_back(self.device)
        return found

    def reconstructed(self, technique: Technique, airlight: list[np.ndarray]) -> np.ndarray:
        """Bring airlight that was evaluated elsewhere to full resolution as the technique does.

        Parameters
        ----------
        airlight : list of (h, w, 3)    of each light, on the lattice's cells

        Returns
        -------
        (H, W, 3) float32
        """
        device, passes = self.device, self.passes
        with self._drawing(technique):
            view, (cells,) = passes.see(technique), self._lattice_textures(technique, 1)
            whole = device.texture((self.scene.camera.width, self.scene.camera.height), 4)
            layers = [device.texture(whole.size, 4) for _ in range(2)]
            on_grid = technique.lattice == "grid"
            for number, values in enumerate([sum(airlight)] if on_grid else airlight):
                cells.write(np.ascontiguousarray(np.pad(values, ((0, 0), (0, 0), (0, 1))), np.float32))
                if not on_grid:
                    passes.reconstruct(whole, technique, view, number, cells)
            passes.combine(tuple(layers), technique, view, cells if on_grid else whole)
            found = read(layers[1])[..., :3]
            device.give_back(cells, whole, *layers)
            view.give_back(device)
        return found

    def _check_turns(self, technique: Technique, airlight_and_pieces: np.ndarray) -> None:
        """Raise InputError where OpenGL cut loops off (scattering.frag.glsl)."""
        if (airlight_and_pieces[..., 3] < 0).any():
            raise InputError(
                f"{technique.name} takes more turns of its loops than {self.device.info.renderer} allows a pixel, and "
                "its picture would lack the rest: take fewer steps."
            )

    def _lattice_textures(self, technique: Technique, count: int) -> list[Any]:
        return [self.passes.lattice_texture(technique) for _ in range(count)]

    @contextmanager
    def _drawing(self, technique: Technique) -> Iterator[None]:
        """Check that the technique can draw the scene, and say in words what OpenGL cannot."""
        import moderngl

        technique.check()
        technique.check_scene(self.scene)
        for light in self.scene.lights:
            check_map_size(self.device, light, technique.shadow_map)
        VISIBILITIES[technique.visibility].check(self.device)
        self.device.begin_drawing()
        try:
            with self.device.taking_back():
                yield
        except moderngl.Error as error:
            camera = self.scene.camera
            raise InputError(
                f"OpenGL cannot draw {camera.width} x {camera.height} pixels with {technique.shadow_map} texels of "
                f"shadow map ({' '.join(str(error).split())}): make one of them smaller."
            ) from None
