"""What a library may raise when it is fed a broken file."""

from __future__ import annotations

import struct
import zlib

FOREIGN_ERRORS: tuple[type[Exception], ...] = (
    ValueError,  # includes UnicodeError and json.JSONDecodeError
    LookupError,
    TypeError,
    AttributeError,
    ArithmeticError,
    AssertionError,
    RuntimeError,  # includes RecursionError and NotImplementedError
    EOFError,
    StopIteration,
    OSError,
    SyntaxError,  # includes xml.etree.ElementTree.ParseError
    struct.error,
    zlib.error,
)
"""Parsers of foreign formats trip over damaged input in their own code, with whatever error lies at hand.

Catch these only where such a library is called or its objects are taken apart.
"""
