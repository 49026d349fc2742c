"""Pictures of a scene on the GPU."""

from __future__ import annotations

from typing import Any

from gpu_impl.device import Device
from scenes.errors import InputError
from scenes.model import Texture

WRAPS = ("repeat", "mirror", "clamp")


class PictureTextures:
    """Uploads each picture once."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._textures: dict[int, Any] = {}
        # an id means something for as long as its object lives
        self._kept: list[Texture] = []

    def bind(self, picture: Texture, unit: int, sampler: str, bitmap: str) -> dict[str, Any]:
        """Bind a picture and give the uniforms of bitmap.glsl, called `sampler` and `bitmap`.

        Raises
        ------
        InputError
            The picture is larger than this OpenGL allows.
        """
        if id(picture) not in self._textures:
            height, width = picture.pixels.shape[:2]
            if max(width, height) > self._device.largest_texture:
                raise InputError(
                    f"{picture.path} has {width} x {height} pixels, and this OpenGL allows "
                    f"{self._device.largest_texture} on a side; make it smaller."
                )
            texture = self._device.texture((width, height), 3)
            texture.write(picture.pixels.tobytes())
            self._device.keep(texture)
            self._textures[id(picture)] = texture
            self._kept.append(picture)
        self._textures[id(picture)].use(unit)
        return {
            sampler: unit,
            f"{bitmap}.to_uv": tuple(picture.to_uv.T.ravel()),
            f"{bitmap}.nearest": picture.nearest,
            f"{bitmap}.wrap": WRAPS.index(picture.wrap),
        }

    def release(self) -> None:
        """Give the textures back."""
        for texture in self._textures.values():
            texture.release()
        self._textures.clear()
        self._kept.clear()
