"""The upsampling pass: the lattice grid/N back to full resolution by a joint bilateral filter."""

from __future__ import annotations

from typing import Any

from gpu_impl.device import Device
from gpu_impl.passes.geometry import GBuffer
from gpu_impl.shader_source import set_uniforms
from scenes.model import Camera


def upsample(device: Device, coarse: Any, camera: Camera, gbuffer: GBuffer, step: int) -> Any:
    """Fill a new full-size texture from one that holds every `step`-th pixel; `coarse` is given back."""
    size = (camera.width, camera.height)
    fine = device.texture(size, 4)
    program = device.program("upsample.frag.glsl")
    coarse.use(0)
    set_uniforms(program, gbuffer.bind(first_unit=1) | {"scattering": 0, "downsample": step, "image_size": size})
    device.fill(program, fine)
    coarse.release()
    return fine
