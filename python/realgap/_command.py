"""The command `realgap`, as a function of the module."""

import sys

from . import _native


def main() -> int:
    """Runs the command with the arguments of the command line.

    >>> from realgap._command import main
    >>> callable(main)
    True
    """
    return _native.command(["realgap", *sys.argv[1:]])
