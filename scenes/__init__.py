"""Scenes: Mitsuba 3 XML files, and the loader that both renderers share."""

from scenes.errors import InputError

__all__ = ["InputError"]
