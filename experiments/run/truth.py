"""Where a run's references come from: estimated by Mitsuba and kept in the cache, or committed beside a suite."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterator
from pathlib import Path

from experiments.suite.schema import CameraChoice, ReferenceChoice
from reference.convergence import Progress
from reference.estimate import Reference, deterministic_reference, estimate_reference
from scenes.loader import load_seen_from
from scenes.model import Scene
from scenes.orbit import orbited

# of a path's frames, scenes and references, so that each technique need not read them again
KEPT = 32


class Truth:
    """Finds references and the scenes of a camera's path, and keeps the last ones.

    Parameters
    ----------
    report : called after each pass of a reference that is estimated
    """

    def __init__(self, report: Callable[[Progress], None] | None = None) -> None:
        self._report = report
        self._references: OrderedDict[tuple[object, ...], Reference] = OrderedDict()
        self._scenes: OrderedDict[tuple[object, ...], Scene] = OrderedDict()

    def reference(self, scene: Scene, choice: ReferenceChoice) -> Reference:
        """Find the reference of a scene.

        Raises
        ------
        InputError
            It cannot be estimated; or it was to be a committed one, and that is missing or of another scene.
        """
        key = scene.digest, choice
        if key not in self._references:
            self._references[key] = self._find(scene, choice)
            _forget(self._references)
        return self._references[key]

    def path(self, scene: Scene, camera: CameraChoice) -> Iterator[Scene]:
        """The scene as each frame of the path sees it, the first as it is given."""
        yield scene
        size = scene.camera.width, scene.camera.height
        own: Scene | None = None
        for angle in camera.angles()[1:]:
            key = scene.digest, angle
            if key not in self._scenes:
                # every turn is about what the scene's own camera looks at
                own = own or load_seen_from(scene.path, None, size, scene.parameters)
                self._scenes[key] = orbited(own, angle)
                _forget(self._scenes)
            yield self._scenes[key]

    def _find(self, scene: Scene, choice: ReferenceChoice) -> Reference:
        if choice.folder is not None:
            from experiments.gate.references import load_reference

            return load_reference(Path(choice.folder), scene)
        if choice.deterministic:
            return deterministic_reference(scene)
        return estimate_reference(scene, choice.goal(), self._report)


def _forget(kept: OrderedDict) -> None:
    while len(kept) > KEPT:
        kept.popitem(last=False)
