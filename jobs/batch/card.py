"""A nest on the page of a batch: its picture, and a line for each machine."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from html import escape
from urllib.parse import quote

from kerfwise.encoder.shown import shown

from .compared import cheapest, quickest
from .figures import clock, metres, money, percent
from .files import file_of
from .groups import HEADS
from .row import Row


def anchor(nest: str) -> str:
    """The place of a nest on the page."""
    return f"n{hashlib.sha256(nest.encode('utf-8', 'surrogateescape')).hexdigest()[:12]}"


def card(nest: str, rows: Sequence[Row]) -> str:
    """The nest, with its rows of all machines."""
    picture = next((row.thumbnail for row in rows if row.thumbnail), "")
    picture = f"<div class=picture>{picture}</div>" if picture else ""
    lines = [
        f'<article id="{anchor(nest)}"><h3>{escape(shown(nest))}</h3>',
        f"<p class=file>{escape(shown(rows[0].source))}</p>{_sheets(rows[0])}{picture}",
        "<table><tr><th>machine<th>time<th>cost<th>idle<th>gap",
        *(line for row in rows for line in _machine(row, rows)),
        "</table>",
    ]
    for title, sentences in (("excuses", list(_excuses(rows))), ("notes", list(_notes(rows)))):
        if sentences:
            listed = "".join(f"<li>{escape(shown(text))}" for text in sentences)
            lines.append(f"<details><summary>{title}: {len(sentences)}</summary><ul>{listed}</ul></details>")
    return "\n".join([*lines, "</article>"])


def _sheets(row: Row) -> str:
    """How many sheets, for which order, by which day, where the job file says something of it."""
    said = [f"{row.quantity} sheets"] if row.quantity > 1 else []
    said += [f"{word} {text}" for word, text in (("order", row.order), ("due", row.due)) if text]
    return f"<p>{escape(shown(', '.join(said)))}</p>" if said else ""


def _machine(row: Row, rows: Sequence[Row]) -> Iterator[str]:
    name, figures = escape(row.machine), row.figures
    if figures is None:
        yield f'<tr><th>{name}<td colspan=4><a class=wrong href="#refused">{escape(HEADS[row.ended])}</a>'
        return
    time_s = _best(clock(figures.time_s), row.machine == quickest(rows))
    cost = _best(money(figures.cost, figures.currency), row.machine == cheapest(rows))
    yield f"<tr><th>{name}<td>{time_s}<td>{cost}<td>{metres(figures.idle_mm)}<td>{percent(figures.gap)}"
    words = {".nc": "program", ".plan.json": "plan", ".svg": "picture", ".html": "page"}
    links = [
        f'<a href="{quote(_path(row, ending))}">{word}</a>' for ending, word in words.items() if _path(row, ending)
    ]
    yield f"<tr class=files><td colspan=5>{' '.join(links)}"


def _best(text: str, is_best: bool) -> str:
    return f"<b>{text}</b>" if is_best else text


def _path(row: Row, ending: str) -> bytes:
    return file_of(row, ending).encode("utf-8", "surrogateescape")


def _excuses(rows: Sequence[Row]) -> Iterator[str]:
    for row in rows:
        if row.figures is not None:
            yield from (f"{row.machine}: {text}" for text in row.figures.excuses)


def _notes(rows: Sequence[Row]) -> Iterator[str]:
    """What is to be known of the nest, once for all machines that say the same."""
    said: dict[str, list[str]] = {}
    for row in rows:
        for text in row.notes:
            said.setdefault(text, []).append(row.machine)
    for text, machines in said.items():
        yield text if len(machines) == len(rows) else f"{', '.join(machines)}: {text}"
