"""A program held against the plan that it is said to be made from, where the program itself says nothing of it.

Some controls take no comments. Then names, zones, the start side, excuses, and what was cut before a stop, are the
plan's, and the program has to follow the plan, cut by cut.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.machine_section import Origin
from kerfwise.rules.rule import Violation

from .program_rules import tolerance_mm
from .relaxed import Relaxed

_RULE = "follows-plan"


@dataclass(frozen=True, eq=False, slots=True)
class Planned:
    """What a plan says: its cuts, those made before a stop among them, what it relaxes, and the machine's zero."""

    cuts: CutSequence
    relaxed: tuple[Relaxed, ...] = ()
    origin: Origin = "drawing"

    def names_of_burns(self) -> list[str]:
        """The first contour of each burn that the plan asks for."""
        return [cut.contour for cut in self.cuts.new if not cut.linked]

    def completed(self, cuts: CutSequence) -> CutSequence:
        """The cuts of a program, with what the plan says of them and the program does not."""
        told = {cut.contour: cut for cut in self.cuts}
        side = cuts.start_side if cuts.start_side is not None else self.cuts.start_side
        return replace(cuts, cuts=tuple(_completed(cut, told.get(cut.contour)) for cut in cuts), start_side=side)


def _completed(cut: Cut, told: Cut | None) -> Cut:
    """The cut with what the plan knows of it; where it joins the torch's ring as planned, its entry is the plan's.

    Beside a corner the ring is as near to several points of the contour, so that nobody can tell the entry from it.
    """
    if told is None:
        return cut
    excused = tuple(dict.fromkeys((*cut.excused, *told.excused)))
    joins = told.lead_in is not None and math.dist(_join(cut), _join(told)) <= 2 * tolerance_mm()
    return replace(cut, zone=cut.zone or told.zone, excused=excused, entry=told.entry if joins else cut.entry)


def _join(cut: Cut) -> Point:
    """Where the torch joins its ring: the end of the lead-in."""
    if cut.lead_in is None:
        return cut.pierce
    x, y = cut.lead_in.vertices[-1, :2].tolist()
    return x, y


def strays_from(planned: Planned, nest: Nest, made: CutSequence, kerf_mm: float) -> Iterator[Violation]:
    """Where a program does not follow its plan: another contour, another entry, pierce or direction, more or fewer."""
    if made.made != planned.cuts.made:
        text = f"it goes on after cut {made.made}, the plan after cut {planned.cuts.made}"
        yield Violation(_RULE, (), text)
        return
    for k, (cut, asked) in enumerate(zip(made.new, planned.cuts.new, strict=False), made.made + 1):
        if cut.contour != asked.contour:
            text = f"cut {k} is of {cut.contour}, the plan says {asked.contour}"
            yield Violation(_RULE, (cut.contour, asked.contour), text, (k,))
        else:
            closed = cut.contour in nest.index and nest.contour(cut.contour).curve.closed
            for text in _differences(cut, asked, closed, kerf_mm):
                yield Violation(_RULE, (cut.contour,), f"cut {k} of {cut.contour} {text}", (k,))
    asked_holes = planned.cuts.pierces
    for k, (hole, said) in enumerate(zip(made.pierces, asked_holes, strict=False), 1):
        if hole.before != said.before or math.dist(hole.at, said.at) > 2 * tolerance_mm(kerf_mm):
            text = f"pierce {k} of its passes is not the one of the plan, at ({said.at[0]:z.2f}, {said.at[1]:z.2f})"
            yield Violation(_RULE, (said.contour,) if said.contour else (), text, (hole.before,))
    if len(made.pierces) != len(asked_holes):
        text = f"it makes {len(made.pierces)} holes in pierce passes, the plan {len(asked_holes)}"
        yield Violation(_RULE, (), text)
    if len(made.new) != len(planned.cuts.new):
        yield Violation(_RULE, (), f"it makes {len(made.new)} cuts, the plan {len(planned.cuts.new)}")


def _differences(cut: Cut, asked: Cut, closed: bool, kerf_mm: float) -> Iterator[str]:
    allowed_mm = 2 * tolerance_mm(kerf_mm)
    if cut.direction != asked.direction:
        yield f"goes {cut.direction if closed else 'the other way'}, the plan says {asked.direction}"
    if cut.torch != asked.torch:
        yield f"is made by torch {cut.torch}, the plan says torch {asked.torch}"
    if cut.linked != asked.linked:
        yield (
            "is linked with the cut before, the plan has it pierced" if cut.linked else "is pierced, the plan links it"
        )
    for what, at, said in (("enters", cut.entry, asked.entry), ("begins", cut.pierce, asked.pierce)):
        apart_mm = math.dist(at, said)
        if what == "begins" and cut.linked and asked.linked and asked.lead_in is not None:
            # It leaves its ring at a low angle, and after a kerf it is out of it: somewhere there it is seen to begin.
            along_mm, off_mm = asked.lead_in.project(at)
            apart_mm = off_mm if along_mm <= kerf_mm else apart_mm
        if apart_mm > allowed_mm:
            yield f"{what} at {_at(at)}, {apart_mm:.2f} mm from where the plan does, {_at(said)}"


def _at(point: Sequence[float]) -> str:
    return f"({point[0]:z.2f}, {point[1]:z.2f})"
