"""What a measurement may look at: a case's scene, picture and reference, each made when it is first asked for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from experiments.run.truth import Truth
from experiments.suite.cases import Case
from gpu_impl.frame import Frame
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import Technique
from reference.estimate import Reference
from scenes.model import Scene


@dataclass(frozen=True)
class View:
    """One frame of a camera's path."""

    scene: Scene
    frame: Frame
    reference: Reference


class Shot:
    """One case while it is measured.

    Parameters
    ----------
    scene : Scene          as the first frame of the case's camera sees it
    renderer : Renderer    of that scene
    truth : Truth          where references come from
    """

    def __init__(self, case: Case, scene: Scene, renderer: Renderer, truth: Truth) -> None:
        self.case, self.scene, self.renderer, self._truth = case, scene, renderer, truth

    @property
    def technique(self) -> Technique:
        """The case's technique, with every setting."""
        return self.case.technique

    @cached_property
    def frame(self) -> Frame:
        """What the technique draws."""
        return self.renderer.render(self.technique)

    @cached_property
    def reference(self) -> Reference:
        """The truth of the same picture."""
        return self._truth.reference(self.scene, self.case.reference)

    def views(self) -> Iterator[View]:
        """Each frame of the camera's path, the still's first; one for a camera that stays where it is."""
        for scene in self._truth.path(self.scene, self.case.camera):
            self.renderer.look(scene)
            try:
                yield View(
                    scene, self.renderer.render(self.technique), self._truth.reference(scene, self.case.reference)
                )
            finally:
                self.renderer.look(self.scene)
