"""The version of the package: that of the library inside."""

from . import _native

__version__: str = _native.versions()[0]
