"""What figures and claims share: scenes, references and pictures, each made once, when the first of them asks."""

from __future__ import annotations

from collections.abc import Callable
from types import TracebackType
from typing import Any, Self, TypeVar

from experiments.figures.rays import RayField
from experiments.renderers import open_renderer
from gpu_impl.device import shared_device
from gpu_impl.frame import Frame
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from reference.estimate import Reference, deterministic_reference
from scenes.loader import load
from scenes.model import Scene

T = TypeVar("T")
# pixels on a side of the pictures whose rays diagrams are drawn of, whatever the size of the other figures
FIELD_SIDE = 128


class Stage:
    """Holds scenes on the GPU while figures are drawn; a context manager.

    Parameters
    ----------
    size : (width, height)    of pictures [pixel]
    tell : callable           told what is being done
    """

    def __init__(self, size: tuple[int, int], tell: Callable[[str], None] = lambda _: None) -> None:
        self.size, self.tell = size, tell
        self._made: dict[tuple[Any, ...], Any] = {}
        self._scenes: list[Scene] = []
        self._renderers: list[Renderer] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for renderer in self._renderers:
            renderer.release()

    def once(self, key: tuple[Any, ...], make: Callable[[], T]) -> T:
        """What `make` returned when it was first asked for under this key."""
        if key not in self._made:
            self._made[key] = make()
        found: T = self._made[key]
        return found

    @property
    def stand_ins(self) -> tuple[str, ...]:
        """Meshes for which a stand-in served, of all scenes that were asked for."""
        return tuple(sorted({name for scene in self._scenes for name in scene.stand_ins}))

    @property
    def gl_renderer(self) -> str:
        """OpenGL's name for what draws."""
        return shared_device().info.renderer

    def scene(self, name: str, size: tuple[int, int] | None = None, **parameters: Any) -> Scene:
        """A shipped scene, at the stage's size or another."""
        size = size or self.size

        def make() -> Scene:
            self._scenes.append(load(name, size=size, **parameters))
            return self._scenes[-1]

        return self.once(("scene", name, size, *sorted(parameters.items())), make)

    def renderer(self, scene: Scene) -> Renderer:
        """What draws a scene; it stays open."""

        def make() -> Renderer:
            self._renderers.append(open_renderer(scene))
            return self._renderers[-1]

        return self.once(("renderer", scene.digest, scene.camera.width, scene.camera.height), make)

    def frame(self, scene: Scene, technique: str, **settings: Any) -> Frame:
        """Draw a scene with a technique and its settings."""
        renderer, found = self.renderer(scene), find_technique(technique, **settings)

        def make() -> Frame:
            self.tell(f"{scene.name}: {technique}")
            return renderer.render(found)

        return self.once(("frame", id(renderer), found), make)

    def reference(self, scene: Scene) -> Reference:
        """The deterministic reference: ray casting and quadrature through the same pixel centres."""

        def make() -> Reference:
            self.tell(f"{scene.name}: reference")
            return deterministic_reference(scene)

        return self.once(("reference", scene.digest, scene.camera.width, scene.camera.height), make)

    def field(self, name: str) -> RayField:
        """All rays of a scene at `FIELD_SIDE`, for diagrams."""

        def make() -> RayField:
            self.tell(f"{name}: lit pieces of all rays")
            return RayField.of_scene(self.scene(name, (FIELD_SIDE, FIELD_SIDE)))

        return self.once(("field", name), make)
