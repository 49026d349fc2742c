"""Where text goes: results to standard output, notices to standard error."""

from __future__ import annotations

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text


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


def plain_table(title: str | Text) -> Table:
    """Make a table with a line under its head and no other, its texts to the left, and no columns yet."""
    return Table(title=title, title_justify="left", caption_justify="left", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
