"""Mitsuba plugins for what real-time work uses and Mitsuba lacks.

Importing this package loads Mitsuba and registers `schlick`, `cornette_shanks` (phase functions) and `phong` (BSDF) in
the variant that `scenes.mitsuba_setup.mitsuba` chose; the same classes serve the scalar and the JIT variants. In
`scalar_rgb` the numbers among their parameters can be read through `mi.traverse` and not set: there they are Python's
own, which Mitsuba cannot change in place.
"""

from __future__ import annotations

from reference.plugins import cornette_shanks, phong, schlick

__all__ = ["cornette_shanks", "phong", "schlick"]
