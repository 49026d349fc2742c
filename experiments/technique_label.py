"""What a technique with its settings is called in tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gpu_impl.techniques import SETTINGS, Technique, find_technique
from scenes.errors import InputError


def own_settings(name: str) -> Technique:
    """The technique of this name as it is by itself; of somebody's own, whose file is not here, what all begin with."""
    try:
        return find_technique(name)
    except InputError:
        return Technique(name, "", "")


def changed_settings(name: str, given: Mapping[str, Any]) -> dict[str, str]:
    """Those of the settings `given` that are not what the technique of this name has by itself, as text."""
    own = own_settings(name)
    return {setting: str(given[setting]) for setting in SETTINGS if str(given[setting]) != str(getattr(own, setting))}


def technique_label(name: str, given: Mapping[str, Any]) -> str:
    """Name of a technique and its changed settings, for people: "Nishita1987, steps 5"."""
    changed = changed_settings(name, given)
    return ", ".join([name, *(f"{setting} {value}" for setting, value in changed.items())])
