"""Exact closed forms with one complex Ei at each end of the segment."""

from __future__ import annotations

from analytic.models.one_ei.closed_form import MODEL

__all__ = ["MODEL"]
