"""Where text goes: results to standard output, notices to standard error."""

from __future__ import annotations

from rich.console import Console


def _console() -> Console:
    """Standard output; where no terminal says how wide it is, wide enough for the table of results."""
    found = Console()
    return found if found.is_terminal else Console(width=max(found.width, 124))


console = _console()
# notices go where they do not disturb --json
notices = Console(stderr=True)


def say(text: str) -> None:
    """Print one line, whatever signs a path in it holds, and as long as it is."""
    console.print(text, highlight=False, markup=False, soft_wrap=True)


def warn(text: str) -> None:
    """Print a notice: the work goes on, but its reader should know."""
    notices.print(text, style="yellow", highlight=False, markup=False, soft_wrap=True)
