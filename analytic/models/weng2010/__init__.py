"""Weng 2010: the thesis's closed forms, as printed and repaired, one file each."""

from __future__ import annotations

from analytic.models.weng2010 import merged

MODELS = (merged.MODEL,)
