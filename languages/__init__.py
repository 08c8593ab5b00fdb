"""Message catalogues: what pages, work sheets and labels say in other languages than English."""

from __future__ import annotations

import gettext
import json
from collections.abc import Callable
from functools import cache
from importlib.resources import files
from io import BytesIO
from typing import Any, NamedTuple

ENGLISH = "en"
LANGUAGES = (ENGLISH, "de", "es", "ru")
"""English stands in the code; the others have their catalogues beside this file."""


class Texts(NamedTuple):
    """What a page says in one language: `tr` of a text, `trn` of a number of things."""

    tr: Callable[[str], str]
    trn: Callable[[str, str, int], str]


@cache
def catalogue(language: str) -> gettext.NullTranslations:
    """The messages of a language; those of English say what they are asked.

    Raises KeyError for a language that is none of `LANGUAGES`.
    """
    if language == ENGLISH:
        return gettext.NullTranslations()
    if language not in LANGUAGES:
        raise KeyError(language)
    return gettext.GNUTranslations(BytesIO(_file(f"{language}.mo")))


def _file(name: str) -> bytes:
    return files(__package__).joinpath(name).read_bytes()


@cache
def texts(language: str) -> Texts:
    """How to say things in a language.

    Examples
    --------
    >>> texts("en").trn("{n} cut", "{n} cuts", 3).format(n=3)
    '3 cuts'
    """
    known = catalogue(language)
    return Texts(known.gettext, known.ngettext)


ENGLISH_TEXTS = texts(ENGLISH)


@cache
def page_texts(of: str = "page") -> dict[str, dict[str, Any]]:
    """The catalogues as a page reads them: by language and English text, of a plural the list of its forms.

    `of` is "page" for what every page says, and "viewer" for what that of the server says besides.
    """
    return {name: json.loads(_file(f"{name}.{of}.json")) for name in LANGUAGES if name != ENGLISH}
