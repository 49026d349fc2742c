"""How far each layer is from the reference's: `experiments.metrics`."""

from __future__ import annotations

from dataclasses import asdict

from experiments.measurements import Measurement, Value
from experiments.measurements.shot import Shot
from experiments.metrics import measure
from reference.estimate import LAYERS


def errors(shot: Shot) -> dict[str, Value]:
    """All metrics of each layer, such as `scattering.rel_95`."""
    columns: dict[str, Value] = {}
    for layer in LAYERS:
        pictures = getattr(shot.frame, layer), getattr(shot.reference, layer)
        found = measure(*pictures, shot.reference.noise(layer))
        columns |= {f"{layer}.{name}": value for name, value in asdict(found).items()}
    return columns


MEASUREMENT = Measurement(errors)
