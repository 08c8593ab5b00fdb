"""The page: data and plain ES modules, set into one HTML file that needs no server and no network."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Iterator, Mapping
from functools import cache
from html import escape
from importlib.resources import files
from types import MappingProxyType
from typing import Any, NamedTuple

_IMPORT = re.compile(r'^import\s+(?:\{[^}]*\}\s+from\s+)?"\./(?P<name>[\w/.-]+\.js)";[ \t]*\n', re.MULTILINE)
_EXPORT = re.compile(r"^export\s+(?=(?:async\s+)?(?:function|class|const|let)\b)", re.MULTILINE)


class Page(NamedTuple):
    """A page: its HTML, and the policy (Content-Security-Policy) that its HTML states."""

    html: str
    policy: str


def page_html(
    data: Mapping[str, Any],
    entry: str = "static.js",
    connect: bool = False,
    more: Mapping[str, str] = MappingProxyType({}),
) -> str:
    """The page of such data, as one HTML file; see `page_and_policy`."""
    return page_and_policy(data, entry, connect, more).html


def page_and_policy(
    data: Mapping[str, Any],
    entry: str = "static.js",
    connect: bool = False,
    more: Mapping[str, str] = MappingProxyType({}),
) -> Page:
    """The page of such data, as one HTML file, and its policy.

    Parameters
    ----------
    data
        What the page shows, as JSON can hold it: `types.js` describes it.
    entry
        The module of `page_files` that the page begins with.
    connect
        Whether the page may ask the server that it came from. Without it every request is forbidden.
    more
        Texts of further modules by name, which `entry` and others may import, and of further style sheets.
    """
    frame = _text("page.html")
    style = "\n".join([_text("page.css"), *(text for name, text in more.items() if name.endswith(".css"))])
    script = bundled(entry, tuple(more.items()))
    allowed = {
        "default-src": "'none'",
        "script-src": _hash_of(script),
        "style-src": _hash_of(style),
        "img-src": "data: blob:",
        **({"connect-src": "'self'"} if connect else {}),
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    policy = "; ".join(f"{key} {value}" for key, value in allowed.items())
    parts = {
        "@policy": escape(policy),
        "@title": escape(str(data.get("title", "kerfwise"))),
        "@style": style,
        "@data": as_script_data(data),
        "@script": script,
    }
    made = []
    for mark, text in parts.items():
        before, _, frame = frame.partition(mark)
        made += [before, text]
    return Page("".join([*made, frame]), policy)


def as_script_data(data: Mapping[str, Any]) -> str:
    r"""JSON that may stand in a script element: nothing in it can end the element, or begin a comment in it.

    Examples
    --------
    >>> as_script_data({"part": "</script>"})
    '{"part":"\\u003c/script>"}'
    """
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"))
    # Half of a surrogate pair, as a file's name may hold, is no UTF-8: JSON may write it as an escape.
    lone = re.sub("[\ud800-\udfff]", lambda half: f"\\u{ord(half[0]):04x}", text)
    return lone.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


@cache
def bundled(entry: str, more: tuple[tuple[str, str], ...] = ()) -> str:
    """The module and all that it imports as one script, each after those that it needs; `more` are names and texts."""
    texts = dict(more)

    def text_of(name: str) -> str:
        return texts[name] if name in texts else _text(name)

    def in_order(name: str) -> Iterator[str]:
        seen.add(name)
        for found in _IMPORT.finditer(text_of(name)):
            if found["name"] not in seen:
                yield from in_order(found["name"])
        yield name

    seen = set[str]()
    return "\n".join(f"// {name}\n{_bare(text_of(name))}" for name in in_order(entry))


def _bare(module: str) -> str:
    """A module's text without imports and exports: in one script all names are known anyway."""
    return _EXPORT.sub("", _IMPORT.sub("", module))


@cache
def _text(name: str) -> str:
    return files(__package__).joinpath("page_files", name).read_text(encoding="utf-8")


def _hash_of(text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
