"""The index of a batch as a page: one file, which needs neither a network nor a script, on a phone and on paper."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from importlib.resources import files
from types import MappingProxyType
from urllib.parse import quote

from kerfwise.encoder.shown import shown, shown_lines
from kerfwise.postproc.report.legend import counted

from .card import anchor, card
from .compared import by_nest, cheapest, quickest, totals
from .figures import NONE, clock, metres, money
from .folded import folded
from .groups import Group, groups_of
from .left import Left
from .row import Row


def page(
    rows: Sequence[Row],
    machines: Sequence[str],
    papers: Mapping[str, str] = MappingProxyType({}),
    left: Sequence[Left] = (),
) -> str:
    """The page: sums a machine, what was refused and what to do, then each nest with its picture.

    `papers` are the names of the work sheets, by machines, `left` programs of earlier runs that no row is about.

    Examples
    --------
    >>> "0 nests" in page([], ["plasma"])
    True
    """
    frame = files(__package__).joinpath("index.html").read_text(encoding="utf-8")
    nests = by_nest(rows)
    planned = sum(row.planned for row in rows)
    said = f"{counted(len(nests), 'nest')}, {counted(len(machines), 'machine')}: {planned} of {len(rows)} planned."
    parts = {
        "@said": escape(said),
        "@totals": "\n".join(_totals(rows, machines, papers)),
        "@refused": "\n".join(_refused(groups_of(rows))),
        "@left": "\n".join(_left(left)),
        "@nests": "\n".join(card(nest, of_nest) for nest, of_nest in nests.items()),
    }
    for mark, text in parts.items():
        before, _, after = frame.partition(mark)
        frame = before + text + after
    return frame.encode("utf-8", "backslashreplace").decode()


def _totals(rows: Sequence[Row], machines: Sequence[str], papers: Mapping[str, str]) -> Iterator[str]:
    """A line a figure and a column a machine: two machines have room on a phone."""
    nests, sums = by_nest(rows).values(), totals(rows, machines)
    lines = {
        "planned": [str(total.planned) for total in sums],
        "refused": [str(total.refused) for total in sums],
        "sheets": [str(total.sheets) for total in sums],
        "time": [clock(total.time_s) for total in sums],
        "cost": [money(total.cost, total.currency) for total in sums],
        "cut": [metres(total.cut_mm) for total in sums],
        "idle": [metres(total.idle_mm) for total in sums],
        "excuses": [str(total.excuses) for total in sums],
    }
    if len(machines) > 1:
        for head, best in (("quickest for", quickest), ("cheapest for", cheapest)):
            lines[head] = [str(sum(best(of) == machine for of in nests)) for machine in machines]
    if papers:
        lines["work sheets"] = [_paper(papers.get(machine)) for machine in machines]
    yield "<tr><th>" + "".join(f"<th>{escape(machine)}" for machine in machines)
    for head, cells in lines.items():
        yield f"<tr><th>{head}" + "".join(f"<td>{cell}" for cell in cells)


def _paper(name: str | None) -> str:
    return NONE if name is None else f'<a href="{quote(name)}">PDF</a>'


def _refused(groups: Sequence[Group]) -> Iterator[str]:
    if groups:
        yield '<h2 id="refused">Refused</h2>'
    for group in groups:
        yield f"<section class=group><h3>{escape(group.head)}</h3><p class=remedy>{escape(group.remedy)}</p>"
        told: dict[str, list[str]] = {}
        for nest, text, on in group.said():
            link = f'<a href="#{anchor(nest)}">{escape(shown(nest))}</a> ({escape(", ".join(on))})'
            told.setdefault(text, []).append(link)
        for text, links in told.items():
            yield f"<p class=who>{', '.join(links)}</p>{_told(text)}"
        yield "</section>"


def _left(left: Sequence[Left]) -> Iterator[str]:
    if left:
        yield '<h2 id="left">Left from earlier runs</h2>'
        yield "<p>No row of this page is about these programs, and this run did not touch them:</p><ul>"
    for one in left:
        link = f'<a href="{quote(one.program.encode("utf-8", "surrogateescape"))}">{escape(shown(one.program))}</a>'
        yield f"<li>{link}: {one.why} ({escape(shown(one.source))})"
    if left:
        yield "</ul>"
        if any(not one.given for one in left):
            yield "<p>With --tidy the batch removes what it wrote of nests that are not given any more.</p>"


def _told(text: str) -> str:
    """What is said of a nest; a long list is opened by a click."""
    short = folded(shown_lines(text))
    told = f"<pre>{escape(short.told)}</pre>"
    if not short.rest:
        return told
    return f"{told}<details><summary>{short.more}</summary><pre>{escape(chr(10).join(short.rest))}</pre></details>"
