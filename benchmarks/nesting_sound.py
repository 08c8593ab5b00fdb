"""Layouts of the benchmark of nesting held to the check, and paragraphs of its page."""

from __future__ import annotations

import sys
import textwrap

from kerfwise.apps.nesting.nests import Nested, nests_from
from kerfwise.apps.nesting.placement.layout import Layout


def sound(layout: Layout) -> Nested:
    """The nests of a layout; a fault that the check finds ends the run."""
    nested = nests_from(layout)
    if nested.faults:
        sys.exit("\n".join(nested.faults))
    return nested


def paragraph(*sentences: str) -> str:
    """Sentences in lines of a page, and an empty line after them."""
    return textwrap.fill(" ".join(sentences), 118, break_long_words=False, break_on_hyphens=False) + "\n"
