"""Imports Mitsuba once, with an LLVM that works and the fastest variant that does."""

from __future__ import annotations

import os
import sys
from functools import cache
from typing import Any

from scenes.errors import InputError
from scenes.llvm import LlvmChoice, prepare

VARIANTS = ("cuda_ad_rgb", "llvm_ad_rgb", "scalar_rgb")


@cache
def mitsuba() -> Any:
    """Return the `mitsuba` module with its variant set.

    A script that has set one before keeps it, and its LLVM library. Otherwise the first of `VARIANTS` that works is
    taken; AIRLIGHT_MITSUBA_VARIANT asks for one by name.

    Raises
    ------
    InputError
        Mitsuba cannot be imported, or the variant that was asked for is unknown or does not work here.
    """
    if "mitsuba" in sys.modules and (chosen := sys.modules["mitsuba"].variant()):
        if chosen not in VARIANTS:
            raise InputError(f"Mitsuba's variant is {chosen}; set one of {', '.join(VARIANTS)}.")
        return sys.modules["mitsuba"]
    try:
        llvm = prepare()
        import mitsuba as mi
    except RuntimeError:
        raise InputError(
            "Dr.Jit was imported before airlight could choose an LLVM library for it: import airlight first, or set "
            "DRJIT_LIBLLVM_PATH to the library."
        ) from None
    except (ImportError, NameError) as error:
        # the wheels of Dr.Jit and Mitsuba link to libatomic, which a bare Debian lacks; what they raise says little
        raise InputError(
            f"Mitsuba cannot be imported ({error}): run `make setup`, or `apt-get install libatomic1`."
        ) from None

    asked = os.environ.get("AIRLIGHT_MITSUBA_VARIANT")
    if asked and asked not in VARIANTS:
        raise InputError(f"AIRLIGHT_MITSUBA_VARIANT is '{asked}'; use one of {', '.join(VARIANTS)}.")
    for variant in (asked,) if asked else VARIANTS:
        if variant_works(mi, variant, llvm):
            mi.set_variant(variant)
            # its warnings are about what airlight reads for itself, and they tear the progress bars
            mi.set_log_level(mi.LogLevel.Error)
            return mi
    raise InputError(f"The Mitsuba variant {asked} does not work here; `airlight doctor` says why.")


def parser_config() -> Any:
    """How scene files are parsed and instantiated: one object for each shape, so that both renderers can name it."""
    mi = mitsuba()
    import mitsuba.parser as parser

    config = parser.ParserConfig(mi.variant())
    config.merge_meshes = False
    config.merge_equivalent = False
    return config


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
