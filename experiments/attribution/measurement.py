"""One technique on one scene: every coalition drawn, and its error split."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiments.attribution.coalitions import Parts, parts_of
from experiments.attribution.pictures import Pictures
from experiments.attribution.shapley import Coalition, coalitions
from experiments.attribution.split import Share, Split, split
from experiments.metrics import Image
from experiments.technique_label import technique_label
from gpu_impl.techniques import Technique
from reference.estimate import Reference
from scenes.errors import InputError
from scenes.model import Scene

# of a picture: the noise of fewer pixels is not told from an error
LEAST_PIXELS = 64
# told what is about to be replaced, and of how many pictures it is one
Tell = Callable[[Coalition, int], None]


def nobody(coalition: Coalition, pictures: int) -> None:
    """Tell nobody."""


@dataclass(frozen=True)
class Attribution:
    """Where the error of a technique's airlight comes from.

    Attributes
    ----------
    technique : Technique
    parts : Parts
    split : Split
    picture : (H, W, 3)                      what the technique draws
    reference, standard_error : (H, W, 3)    what it is held against
    deterministic : bool                     the reference has no noise, and its standard error is a bound
    other_surfaces : (H, W)                  where OpenGL sees another surface than the reference does
    """

    technique: Technique
    parts: Parts
    split: Split
    picture: Image
    reference: Image
    standard_error: Image
    deterministic: bool
    other_surfaces: NDArray[np.bool_]

    @property
    def label(self) -> str:
        """Name and changed settings of the technique, for people."""
        return technique_label(self.technique.name, vars(self.technique))

    @property
    def in_other_surfaces(self) -> float:
        """How much of the whole squared error lies where another surface is seen; NaN where the whole is noise."""
        if self.split.whole.is_noise:
            return float("nan")
        squares = self.split.whole.signed**2 - (0.0 if self.deterministic else self.standard_error**2)
        return float(squares[self.other_surfaces].sum() / squares.sum())

    def of_mean(self, share: Share) -> float:
        """Root of a squared error over the mean of the reference, with the square's sign: a fraction."""
        return float(np.copysign(np.sqrt(abs(share.value)), share.value) / np.mean(self.reference))


def check_size(scene: Scene) -> None:
    """Raise InputError where a picture has too few pixels for its error to be told from the reference's noise."""
    if scene.camera.width * scene.camera.height < LEAST_PIXELS:
        raise InputError(f"An error is split over at least {LEAST_PIXELS} pixels; ask for a larger picture.")


def attribute(pictures: Pictures, technique: Technique, reference: Reference, tell: Tell = nobody) -> Attribution:
    """Draw all coalitions of the technique's parts and split its error.

    Parameters
    ----------
    pictures : Pictures      of the scene
    reference : Reference    of the same scene
    tell : callable          for a progress bar

    Raises
    ------
    InputError
        The picture has fewer than `LEAST_PIXELS`, the reference is of another scene, or the technique cannot draw the
        scene, or not with some parts replaced.
    """
    if reference.scene_digest != pictures.scene.digest:
        raise InputError(
            "The reference is of another scene, or of other parameters; make it from the scene that is drawn."
        )
    check_size(pictures.scene)
    parts = parts_of(technique, pictures.scene)
    chosen = coalitions(parts.there)
    drawn = {}
    for coalition in chosen:
        tell(coalition, len(chosen))
        try:
            drawn[coalition] = pictures.draw(technique, coalition)
        except InputError as error:
            if not coalition:
                raise
            exact = " and ".join(part for part in parts.there if part in coalition)
            raise InputError(
                f"The error of {technique.name} cannot be split, for with exact {exact}: {error}"
            ) from None
    noise, deterministic = reference.standard_error("scattering"), reference.estimate.stopped_by == "exact"
    found = split(parts.there, drawn, reference.scattering, noise, is_bound=deterministic)
    return Attribution(
        technique,
        parts,
        found,
        drawn[Coalition()],
        reference.scattering,
        noise,
        deterministic,
        pictures.other_surfaces,
    )
