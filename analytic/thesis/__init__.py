"""Weng 2010, "Real-Time Analytical Volumetric Shadows Algorithm": its equations in mpmath, as printed and repaired.

One file per part of the thesis, one function per equation, in the thesis's letters; `audit` measures each.
"""
