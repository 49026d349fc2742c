"""One HTML page a run, which needs no server and nothing beside itself: summary, table, plots and a viewer."""

from experiments.report.report import write_report

__all__ = ["write_report"]
