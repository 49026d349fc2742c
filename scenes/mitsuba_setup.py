"""Imports Mitsuba once, with an LLVM that works and the fastest variant that does."""

from __future__ import annotations

import os
from functools import cache
from typing import Any

from scenes.errors import InputError
from scenes.llvm import LlvmChoice, prepare

VARIANTS = ("cuda_ad_rgb", "llvm_ad_rgb", "scalar_rgb")


@cache
def mitsuba() -> Any:
    """Return the `mitsuba` module with its variant set.

    The first of `VARIANTS` that works is taken; AIRLIGHT_MITSUBA_VARIANT asks for one by name.

    Raises
    ------
    InputError
        The variant that was asked for is unknown or does not work here.
    """
    llvm = prepare()
    import mitsuba as mi

    asked = os.environ.get("AIRLIGHT_MITSUBA_VARIANT")
    if asked and asked not in VARIANTS:
        raise InputError(f"AIRLIGHT_MITSUBA_VARIANT is '{asked}'; use one of {', '.join(VARIANTS)}.")
    for variant in (asked,) if asked else VARIANTS:
        if variant_works(mi, variant, llvm):
            mi.set_variant(variant)
            return mi
    raise InputError(f"The Mitsuba variant {asked} does not work here; `airlight doctor` says why.")


def variant_works(mi: Any, variant: str, llvm: LlvmChoice) -> bool:
    """Tell whether Mitsuba's `variant` can be used on this machine (without leaving it set)."""
    if variant == "llvm_ad_rgb" and llvm.usable is None:
        # asking Dr.Jit would load a library that may abort the process at the first kernel
        return False
    before = mi.variant()
    try:
        mi.set_variant(variant)
    except ImportError:
        return False
    if before:
        mi.set_variant(before)
    return True
