"""The thesis's claims, each with its test and the rule of its verdict. A new one is a `Claim` in one of these files."""

from __future__ import annotations

from experiments.figures.claims import cost, limits, mathematics, pictures

CLAIMS = (*pictures.CLAIMS, *cost.CLAIMS, *mathematics.CLAIMS, *limits.CLAIMS)
