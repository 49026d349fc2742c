"""One technique on one scene: every coalition drawn, and its error split."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from experiments.attribution.coalitions import Parts, parts_of
from experiments.attribution.pictures import Pictures
from experiments.attribution.shapley import Coalition, coalitions
from experiments.attribution.split import Share, Split, split
from experiments.metrics import Image
from experiments.technique_label import technique_label
from gpu_impl.techniques import Technique
from reference.estimate import Reference
from scenes.errors import InputError

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
    """

    technique: Technique
    parts: Parts
    split: Split
    picture: Image
    reference: Image
    standard_error: Image

    @property
    def label(self) -> str:
        """Name and changed settings of the technique, for people."""
        return technique_label(self.technique.name, vars(self.technique))

    def of_mean(self, share: Share) -> float:
        """Root of a squared error over the mean of the reference, with the square's sign: a fraction."""
        return float(np.copysign(np.sqrt(abs(share.value)), share.value) / np.mean(self.reference))


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
        The reference is of another scene, or the technique cannot draw the scene, or not with some parts replaced.
    """
    if reference.scene_digest != pictures.scene.digest:
        raise InputError(
            "The reference is of another scene, or of other parameters; make it from the scene that is drawn."
        )
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
    noise = reference.standard_error("scattering")
    found = split(parts.there, drawn, reference.scattering, noise)
    return Attribution(technique, parts, found, drawn[Coalition()], reference.scattering, noise)
