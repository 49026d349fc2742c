"""Scenes: Mitsuba 3 XML files, and the loader that both renderers share.

>>> import scenes
>>> scenes.load("donut_dragon.xml", phase="hg", g=0.6).phase.mean_cosine
0.6
"""

from typing import Any

from scenes.errors import InputError

__all__ = ["InputError", "load"]


def __getattr__(name: str) -> Any:
    # on demand: the command line's --help has no use for numpy
    if name == "load":
        from scenes.loader import load

        return load
    raise AttributeError(f"module 'scenes' has no attribute '{name}'")
