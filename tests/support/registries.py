"""Keeps parts of somebody's own out of the other tests of a process."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.lattices import LATTICES
from gpu_impl.visibilities import VISIBILITIES


@contextmanager
def restored_registries() -> Iterator[None]:
    """Forget, behind the block, what was made known in it."""
    registries: tuple[dict, ...] = (AIRLIGHT_MODELS, LATTICES, VISIBILITIES)
    before = [dict(registry) for registry in registries]
    try:
        yield
    finally:
        for registry, known in zip(registries, before, strict=True):
            registry.clear()
            registry.update(known)
