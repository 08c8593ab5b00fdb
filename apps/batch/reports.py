"""The index of a batch as a page and as data, and its work sheets, one PDF a machine."""

from __future__ import annotations

import csv
import hashlib
import io
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from html import escape
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any
from urllib.parse import quote

from kerfwise.apps.work_sheets.work_sheet import WorkSheet, about_of_job, sheets_pdf, work_sheet
from kerfwise.encoder.display import NONE, clock, metres, money, percent
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.escape import as_cell, escape_lines, escape_text
from kerfwise.encoder.files import read_limited
from kerfwise.jobs.inputs import silent
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.postproc.output_files import write_files
from kerfwise.postproc.report.legend import counted

from .result import HEADS, PLAN, Group, Row, cheapest, groups_of, quickest, rows_by_nest, totals, truncate
from .store import UNREADABLE, StaleOutput, file_of, has_content, key_of, remove
from .tasks import Changed, NestTask, expect_same, task_inputs

# The index of a batch: one page, one table, one file of data. The same rows give the same bytes.

FORMAT = "kerfwise-batch-index/1"
COLUMNS = ("nest", "file", "quantity", "order", "due", "machine", "ended", "time_s", "cost", "currency", "idle_mm",
           "cut_mm", "pierces", "contours", "gap", "excuses", "state", "quickest", "cheapest", "program",
           "told")  # fmt: skip


def index_files(
    rows: Sequence[Row],
    machines: Sequence[str],
    papers: Mapping[str, str] = MappingProxyType({}),
    left: Sequence[StaleOutput] = (),
) -> Mapping[str, str]:
    """index.html, index.csv and index.json of the rows, by their names.

    `papers` are the work sheets of machines, `left` programs of earlier runs that no row is about.
    """
    data = {**_data(rows, machines, papers), "left": [asdict(one) | {"why": one.why} for one in left]}
    return {
        "index.html": page(rows, machines, papers, left),
        "index.csv": _table(rows),
        "index.json": json.dumps(data, indent=1) + "\n",
    }


def _table(rows: Sequence[Row]) -> str:
    """A line a row, and its columns named on top: numbers with a point, empty where there is none."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    for of_nest in rows_by_nest(rows).values():
        best = {"quickest": quickest(of_nest), "cheapest": cheapest(of_nest)}
        for row in of_nest:
            figures = {} if row.figures is None else asdict(row.figures) | {"excuses": len(row.figures.excuses)}
            said = {"nest": row.nest, "file": row.source, "machine": row.machine, "ended": row.ended}
            short = truncate(row.told)
            said["told"] = f"{short.told}\n  {short.more}" if short.more else row.told
            sheets = {"quantity": row.quantity, "order": row.order, "due": row.due}
            marks = {column: "yes" if machine == row.machine else "" for column, machine in best.items()}
            cells = {**said, **sheets, **figures, **marks, "program": file_of(row, ".nc")}
            writer.writerow({column: as_cell(value) for column, value in cells.items()})
    return text.getvalue().encode("utf-8", "backslashreplace").decode()


def _data(rows: Sequence[Row], machines: Sequence[str], papers: Mapping[str, str]) -> Mapping[str, Any]:
    return {
        "format": FORMAT,
        "machines": [
            asdict(total) | ({"sheets_pdf": papers[total.machine]} if total.machine in papers else {})
            for total in totals(rows, machines)
        ],
        "nests": [
            {
                "nest": nest,
                "file": of_nest[0].source,
                "quantity": of_nest[0].quantity,
                "order": of_nest[0].order,
                "due": of_nest[0].due,
                "quickest": quickest(of_nest),
                "cheapest": cheapest(of_nest),
                "on": [_row(row) for row in of_nest],
            }
            for nest, of_nest in rows_by_nest(rows).items()
        ],
        "refused": [
            {
                "what": group.head,
                "remedy": group.remedy,
                "rows": [{"nest": row.nest, "machine": row.machine, "told": row.told} for row in group.rows],
            }
            for group in groups_of(rows)
        ],
    }


def _row(row: Row) -> Mapping[str, Any]:
    figures = {} if row.figures is None else asdict(row.figures)
    files = {} if not row.files else {"program": file_of(row, ".nc"), "sha256": dict(row.files)}
    return {"machine": row.machine, "ended": row.ended, "told": row.told, "notes": row.notes, **figures, **files}


# The index of a batch as a page: one file, which needs neither a network nor a script, on a phone and on paper.


def page(
    rows: Sequence[Row],
    machines: Sequence[str],
    papers: Mapping[str, str] = MappingProxyType({}),
    left: Sequence[StaleOutput] = (),
) -> str:
    """The page: sums a machine, what was refused and what to do, then each nest with its picture.

    `papers` are the names of the work sheets, by machines, `left` programs of earlier runs that no row is about.

    Examples
    --------
    >>> "0 nests" in page([], ["plasma"])
    True
    """
    frame = files(__package__).joinpath("index.html").read_text(encoding="utf-8")
    nests = rows_by_nest(rows)
    planned = sum(row.planned for row in rows)
    summary = f"{counted(len(nests), 'nest')}, {counted(len(machines), 'machine')}: {planned} of {len(rows)} planned."
    parts = {
        "@said": escape(summary),
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
    nests, sums = rows_by_nest(rows).values(), totals(rows, machines)
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
        by_text: dict[str, list[str]] = {}
        for nest, text, on in group.said():
            link = f'<a href="#{anchor(nest)}">{escape(escape_text(nest))}</a> ({escape(", ".join(on))})'
            by_text.setdefault(text, []).append(link)
        for text, links in by_text.items():
            yield f"<p class=who>{', '.join(links)}</p>{_told(text)}"
        yield "</section>"


def _left(left: Sequence[StaleOutput]) -> Iterator[str]:
    if left:
        yield '<h2 id="left">Left from earlier runs</h2>'
        yield "<p>No row of this page is about these programs, and this run did not touch them:</p><ul>"
    for one in left:
        link = (
            f'<a href="{quote(one.program.encode("utf-8", "surrogateescape"))}">{escape(escape_text(one.program))}</a>'
        )
        yield f"<li>{link}: {one.why} ({escape(escape_text(one.source))})"
    if left:
        yield "</ul>"
        if any(not one.given for one in left):
            yield "<p>With --tidy the batch removes what it wrote of nests that are not given any more.</p>"


def _told(text: str) -> str:
    """What is said of a nest; a long list is opened by a click."""
    short = truncate(escape_lines(text))
    body = f"<pre>{escape(short.told)}</pre>"
    if not short.rest:
        return body
    return f"{body}<details><summary>{short.more}</summary><pre>{escape(chr(10).join(short.rest))}</pre></details>"


# A nest on the page of a batch: its picture, and a line for each machine.


def anchor(nest: str) -> str:
    """The place of a nest on the page."""
    return f"n{hashlib.sha256(nest.encode('utf-8', 'surrogateescape')).hexdigest()[:12]}"


def card(nest: str, rows: Sequence[Row]) -> str:
    """The nest, with its rows of all machines."""
    picture = next((row.thumbnail for row in rows if row.thumbnail), "")
    picture = f"<div class=picture>{picture}</div>" if picture else ""
    lines = [
        f'<article id="{anchor(nest)}"><h3>{escape(escape_text(nest))}</h3>',
        f"<p class=file>{escape(escape_text(rows[0].source))}</p>{_sheets(rows[0])}{picture}",
        "<table><tr><th>machine<th>time<th>cost<th>idle<th>gap",
        *(line for row in rows for line in _machine(row, rows)),
        "</table>",
    ]
    for title, sentences in (("excuses", list(_excuses(rows))), ("notes", list(_notes(rows)))):
        if sentences:
            listed = "".join(f"<li>{escape(escape_text(text))}" for text in sentences)
            lines.append(f"<details><summary>{title}: {len(sentences)}</summary><ul>{listed}</ul></details>")
    return "\n".join([*lines, "</article>"])


def _sheets(row: Row) -> str:
    """How many sheets, for which order, by which day, where the job file says something of it."""
    words = [f"{row.quantity} sheets"] if row.quantity > 1 else []
    words += [f"{word} {text}" for word, text in (("order", row.order), ("due", row.due)) if text]
    return f"<p>{escape(escape_text(', '.join(words)))}</p>" if words else ""


def _machine(row: Row, rows: Sequence[Row]) -> Iterator[str]:
    name, figures = escape(row.machine), row.figures
    if figures is None:
        yield f'<tr><th>{name}<td colspan=4><a class=wrong href="#refused">{escape(HEADS[row.ended])}</a>'
        return
    time_s = _best(clock(figures.time_s), row.machine == quickest(rows))
    cost = _best(money(figures.cost, figures.currency), row.machine == cheapest(rows))
    yield f"<tr><th>{name}<td>{time_s}<td>{cost}<td>{metres(figures.idle_mm)}<td>{percent(figures.gap)}"
    if figures.excuses:
        yield f"<tr class=files><td colspan=5><span class=state>{escape(figures.state)}</span>"
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
    by_text: dict[str, list[str]] = {}
    for row in rows:
        for text in row.notes:
            by_text.setdefault(text, []).append(row.machine)
    for text, machines in by_text.items():
        yield text if len(machines) == len(rows) else f"{', '.join(machines)}: {text}"


# The work sheets of a batch: one PDF a machine, made again only where a plan on it has changed.

SHEETS_FORMAT = "kerfwise-batch-sheets/1"
RECORD = ".sheets.json"
"""What the name of the record ends in that says what a PDF was made of."""


@dataclass(frozen=True, slots=True)
class Papers:
    """The PDF of each machine that has one, by its name in the folder of the batch; `told` is who has no sheet."""

    files: Mapping[str, str] = field(default_factory=dict)
    told: tuple[str, ...] = ()


def papers_of(rows: Mapping[NestTask, Row], machines: Iterable[str], out: Path, *, make: bool) -> Papers:
    """The work sheets of all that is planned, machine by machine, in the order of the rows.

    A PDF that was made of the same plans is kept as it is. One of other plans is made again or, where `make` does not
    say so, removed: nobody should cut by an old sheet. Raises InputError if one cannot be written or removed.
    """
    files, notes = dict[str, str](), list[str]()
    for machine in machines:
        planned = {piece: row for piece, row in rows.items() if row.machine == machine and row.planned}
        pdf, record = out / f"{machine}.pdf", out / f"{machine}{RECORD}"
        key = _key(planned)
        if planned and _is_finished(pdf, record, key):
            files[machine] = pdf.name
            continue
        leave_papers([machine], out)
        sheets = _work_sheets(planned, out, notes) if make else ()
        if sheets:
            paper = sheets_pdf(sheets)
            whole: dict[Path, str | bytes] = {pdf: paper}
            if len(sheets) == len(planned):  # else it is tried again
                whole[record] = _record(key, paper)
            write_files(whole)
            files[machine] = pdf.name
    return Papers(files, tuple(notes))


def leave_papers(machines: Iterable[str], out: Path) -> None:
    """Remove the work sheets of machines, as before a program on them gives way to another.

    Raises InputError if one cannot be removed.
    """
    for machine in machines:
        for ending in (RECORD, ".pdf"):
            remove(out / f"{machine}{ending}", "older plans")


def _key(planned: Mapping[NestTask, Row]) -> str:
    """The sha256 of all that stands on the sheets: what each plan was made of, its files, and their order."""
    return key_of([], {"sheets": [(row.nest, row.key, dict(row.files)) for row in planned.values()]})


def _is_finished(pdf: Path, record: Path, key: str) -> bool:
    try:
        content: Any = json.loads(read_limited(record))
        return content["format"] == SHEETS_FORMAT and content["key"] == key and has_content(pdf, content["sha256"])
    except (*UNREADABLE, LookupError, TypeError, RecursionError):
        return False


def _record(key: str, data: bytes) -> str:
    return (
        json.dumps({"format": SHEETS_FORMAT, "key": key, "sha256": hashlib.sha256(data).hexdigest()}, indent=1) + "\n"
    )


def _work_sheets(planned: Mapping[NestTask, Row], out: Path, notes: list[str]) -> Sequence[WorkSheet]:
    sheets = []
    for piece, row in planned.items():
        try:
            sheets.append(_sheet(piece, row, out))
        except (InputError, RulesConflict, Changed) as error:
            notes.append(f"no work sheet for {escape_text(row.nest)} on {row.machine}: {error}")
    return sheets


def _sheet(piece: NestTask, row: Row, out: Path) -> WorkSheet:
    expect_same(piece, row.key)
    inputs = task_inputs(piece, silent)
    program, plan = (out / file_of(row, ending) for ending in (".nc", PLAN))
    return work_sheet(inputs, read_plan(plan), program, about=about_of_job(inputs.job))
