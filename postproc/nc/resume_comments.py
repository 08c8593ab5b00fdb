"""What a program that goes on after a stop says of what is already cut, in comments that a control passes over.

    (RESUME AFTER CUT 2)
    (OUT 1 P1.hole1 ZONE 1 CCW PIERCE 30 42)
    (OUT 1 LEAD IN 30 42 0 30 36.75 0)
    (OUT 1 LEAD OUT 30 36.75 0 31 36.75 0)
    (OUT 2 P1.outer ZONE 1 CW PIERCE 8 3.25)
    (OUT 2 TAB 40 12 0.5)

Each vertex of a lead is x, y and the bulge of the segment that begins there. A lead that has no room on one line goes
on in the next comment with the same words. A cut that was linked with the one before has LINK IN instead of LEAD IN. Of
a tab the middle and the width are told. A cut that broke off, and is made again, is told as BROKEN instead of OUT.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.models.plan.plan import Plan, PlannedCut
from kerfwise.postproc.dialects import Dialect

from .blocks import comment, number, room_for

DECIMALS = 6


def resume_comment(plan: Plan, dialect: Dialect) -> Iterator[str]:
    """That the program goes on after a stop, and after which cut; nothing for a plan that begins with cut 1."""
    if plan.already:
        again = "" if plan.broken_off is None else f", CUT {plan.resumed_after + 1} AGAIN"
        yield comment(dialect, f"RESUME AFTER CUT {plan.resumed_after}{again}")


def out_comments(plan: Plan, names: Mapping[str, str], dialect: Dialect) -> Iterator[str]:
    """What is already cut, cut by cut, and what broke off."""
    for k, planned in enumerate(plan.already_cut, 1):
        yield from _cut(f"OUT {k}", planned, names, dialect)
    if plan.broken_off is not None:
        yield from _cut(f"BROKEN {plan.resumed_after + 1}", plan.broken_off, names, dialect)


def _cut(head: str, planned: PlannedCut, names: Mapping[str, str], dialect: Dialect) -> Iterator[str]:
    cut = planned.cut
    place = " ".join(number(v, DECIMALS) for v in cut.pierce)
    yield comment(
        dialect, head, names.get(cut.contour, cut.contour), f"ZONE {cut.zone} {cut.direction.upper()} PIERCE {place}"
    )
    for name, lead in (("IN", cut.lead_in), ("OUT", cut.lead_out)):
        if lead is not None:
            what = "LINK" if cut.linked and name == "IN" else "LEAD"
            for words in _lines(lead, room_for(dialect, f"{head} {what} {name}")):
                yield comment(dialect, f"{head} {what} {name}", " ".join(words))
    for tab in cut.tabs:
        yield comment(dialect, f"{head} TAB", " ".join(number(v, DECIMALS) for v in (*tab.at, tab.width_mm)))


def _lines(lead: Curve, room: int) -> Iterator[Sequence[str]]:
    """The vertices as words, as many whole ones at a time as there is room for."""
    line: list[str] = []
    for row in lead.as_rows():
        x, y, bulge = row if len(row) == 3 else (*row, 0.0)
        vertex = [number(v, DECIMALS) for v in (x, y, bulge)]
        if line and len(" ".join([*line, *vertex])) > room:
            yield line
            line = []
        line += vertex
    yield line
