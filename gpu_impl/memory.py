"""What is allocated on the GPU, counted as it is allocated, and what a technique keeps there and takes to set up.

Weng 2010 claims "neither pre-computation nor storage". `footprint` measures both.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import wraps
from typing import Any

import numpy as np

from gpu_impl.device import Device
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import Technique
from scenes.model import Scene

# what the passes call of moderngl.Context that allocates memory
ALLOCATORS = ("buffer", "texture", "depth_renderbuffer")
# bytes of a component of each type of theirs; a depth buffer has 24 bits, padded to 4 bytes, and is "f4" to moderngl
COMPONENT_BYTES = {"f1": 1, "f4": 4, "u4": 4}
# pixels on a side of the picture whose set-up is timed
SMALL = 64


class Tally:
    """The buffers and textures that were allocated while it ran.

    What was dropped without being released still counts: OpenGL holds it.
    """

    def __init__(self) -> None:
        self._held: list[Any] = []
        self._peak = 0

    def add(self, allocated: Any) -> None:
        """Count a moderngl object."""
        self._held.append(allocated)
        self._peak = max(self._peak, self.held)

    @property
    def held(self) -> int:
        """What is allocated now [byte]."""
        import moderngl

        self._held = [one for one in self._held if not isinstance(one.mglo, moderngl.InvalidObject)]
        return sum(map(size_in_bytes, self._held))

    def peak(self) -> int:
        """Return the most that was allocated at a time since the last call [byte]."""
        peak, self._peak = self._peak, self.held
        return peak


def size_in_bytes(allocated: Any) -> int:
    """Size of a moderngl buffer, texture or renderbuffer [byte], as it was asked for."""
    if isinstance(allocated.size, int):
        return allocated.size
    return int(np.prod(allocated.size)) * allocated.components * COMPONENT_BYTES[allocated.dtype]


@contextmanager
def tally(context: Any) -> Iterator[Tally]:
    """Count what a context allocates meanwhile, whoever asks it."""
    counted = Tally()

    def counting(allocate: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(allocate)
        def allocated(*args: Any, **settings: Any) -> Any:
            counted.add(made := allocate(*args, **settings))
            return made

        return allocated

    for name in ALLOCATORS:
        # the instance's own attribute hides the method, until it is deleted
        setattr(context, name, counting(getattr(context, name)))
    try:
        yield counted
    finally:
        for name in ALLOCATORS:
            delattr(context, name)


@dataclass(frozen=True)
class Footprint:
    """What a technique costs beside its frames' time.

    Attributes
    ----------
    scene_bytes : int              meshes and pictures, which any technique needs
    scene_milliseconds : float     making the meshes ready, for any technique: the search for closed ones, and uploads
    storage_bytes : int            what the technique keeps from one frame to the next
    frame_bytes : int              the most that a frame holds beside both while it is drawn
    compile_milliseconds : float   compiling its shaders: once a program, for all scenes
    setup_milliseconds : float     making and uploading what it keeps: once a scene ("pre-computation")
    """

    scene_bytes: int
    scene_milliseconds: float
    storage_bytes: int
    frame_bytes: int
    compile_milliseconds: float
    setup_milliseconds: float


def footprint(scene: Scene, technique: Technique, device: Device, frames: int = 3) -> Footprint:
    """Measure a technique on a scene that is uploaded anew.

    A march of one step with one texel of shadow map is drawn before: what it leaves behind is the scene's, and what it
    has to compile is every technique's. The technique's first frame in a renderer without its programs is longer than
    in further renderers by what compiling takes; the first there is longer than the later ones by what its set-up
    takes, of which the median over the renderers is taken. Where the driver keeps compiled shaders on disk, compiling
    is what reading them takes.

    Parameters
    ----------
    frames : int    later ones, whose median is subtracted; as many renderers have their programs from the first
    """
    technique.check()
    technique.check_scene(scene)
    before = Technique("before", "uniform_march", "riemann", steps=1, shadow_map=1)
    fresh = Device(device.context)
    # set-up is the same for any picture, and is not lost in the frames' own time where those are short
    small = replace(scene, camera=replace(scene.camera, width=SMALL, height=SMALL))
    with tally(device.context) as counted:
        ready, first, later = [], [], []
        for _ in range(1 + frames):
            begin = time.perf_counter()
            with Renderer(small, fresh) as renderer:
                device.context.finish()
                ready.append(1e3 * (time.perf_counter() - begin))
                renderer.frame_time(before, 0)
                # a frame's textures wait for the next one without holding anything
                fresh.release_spare_textures()
                scene_bytes = counted.held
                first.append(renderer.frame_time(technique, 1))
                later.append(np.median([renderer.frame_time(technique, 2 + number) for number in range(frames)]))
                fresh.release_spare_textures()
                storage_bytes = counted.held - scene_bytes
        with Renderer(scene, fresh) as renderer:
            renderer.frame_time(technique, 0)
            fresh.release_spare_textures()
            counted.peak()
            renderer.frame_time(technique, 1)
            frame_bytes = counted.peak() - storage_bytes - scene_bytes
    fresh.release()
    return Footprint(
        scene_bytes,
        float(np.median(ready)),
        storage_bytes,
        frame_bytes,
        compile_milliseconds=max(first[0] - float(np.median(first[1:])), 0.0),
        setup_milliseconds=max(float(np.median(np.subtract(first[1:], later[1:]))), 0.0),
    )
