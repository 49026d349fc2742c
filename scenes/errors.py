"""The one exception that ends a command with a sentence instead of a traceback."""

from __future__ import annotations


class InputError(Exception):
    """What was given cannot be used: a missing mesh, an unsupported plugin, no OpenGL, an unwritable folder.

    Its text is one clear sentence that names the file (or the setting) and the cure. The command line prints it
    and exits with code 2; in Python it is an ordinary exception.
    """
