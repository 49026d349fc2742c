"""Suites: TOML files that say which cases are measured, and how. `schema` says what such a file may hold."""

from experiments.suite.cases import Case, cases_of
from experiments.suite.reading import load_suite, shipped
from experiments.suite.schema import Suite, TechniqueChoice

__all__ = ["Case", "Suite", "TechniqueChoice", "cases_of", "load_suite", "shipped"]
