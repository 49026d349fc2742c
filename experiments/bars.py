"""Progress bars beside the results, on standard error."""

from __future__ import annotations

from types import TracebackType
from typing import Self

from rich.progress import Progress, ProgressColumn

from experiments.console import notices


class Bars:
    """Holds bars that whoever inherits opens with the first of them, and closes them; a context manager."""

    def __init__(self, *columns: ProgressColumn) -> None:
        self._progress = Progress(*columns, console=notices)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._progress.live.is_started:
            self._progress.stop()
