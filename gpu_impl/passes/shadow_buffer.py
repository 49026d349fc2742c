"""A shadow map in a buffer, as Weng 2010, chapter 5, keeps it: "texture buffer to store shadow maps"."""

from __future__ import annotations

from dataclasses import replace

from gpu_impl.device import Device
from gpu_impl.passes.shadow_map import ShadowMap


def in_buffer(device: Device, shadow_map: ShadowMap) -> ShadowMap:
    """Move a map from its texture to a buffer, row by row; the texture is given back.

    moderngl knows no texture buffers. A shader storage buffer stands in: it is read alike, by a texel's number and
    without a filter, and holds the same bits.
    """
    texture = shadow_map.texture
    buffer = device.buffer(4 * texture.width * texture.height)
    texture.read_into(buffer)
    device.give_back(texture)
    return replace(shadow_map, texture=None, buffer=buffer)
