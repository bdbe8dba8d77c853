"""The command `realgap`, which is a function of the module."""

import sys

from . import _native


def main() -> int:
    """Run the command with the words that were typed.

    >>> from realgap._command import main
    >>> callable(main)
    True
    """
    return _native.command(["realgap", *sys.argv[1:]])
