"""Who is told how a run goes; apart from the cluster, which takes long to import."""

from __future__ import annotations

from typing import Any

from experiments.run.rows import Row


class Watcher:
    """Told how a run goes; the terminal shows it, tests ignore it."""

    def begin(self, done: int, total: int) -> None:
        """So many cases are there already, of so many."""

    def step(self, event: dict[str, Any]) -> None:
        """A worker began a case, or got further with it; from another thread."""

    def case(self, row: Row) -> None:
        """A case is finished."""
