"""Rule marks-first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Ids, Nest
from kerfwise.rules.options.kind import Choice
from kerfwise.rules.options.option import setting
from kerfwise.rules.rule import Rule, Violation
from kerfwise.rules.statements import Contiguous, Precede

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

WHY = "marks made after metal is cut through are out of place"


@dataclass(frozen=True, slots=True)
class MarksFirstOptions:
    """How far the rule reaches."""

    scope: Literal["sheet", "part"] = setting(
        "sheet", Choice(("sheet", "part")), "marks before the first cut of the whole sheet, or of their own part"
    )


class MarksFirst(Rule[MarksFirstOptions]):
    """Marks are made before anything is cut through.

    ## What it does

    With `scope: sheet` every mark of the nest comes before the first contour that is cut through; with `scope: part`
    the marks of a part come before its own holes and outer contour only.

    ## Links, tabs and other cuts

    - **Links**: A mark is never linked: the torch goes off before it.
    - **Tabs**: Only outer contours have tabs.
    - **Common cuts**: Marks come before them, as before everything that is cut.
    - **Scrap lines**: Marks come before them, as before everything that is cut.

    ## Why

    Metal moves as soon as it is cut: heat bends it and parts shift in their kerf, so that a line marked later is out
    of place. Common practice of plants that scribe bend lines and part numbers; the machine changes its tool once.

    ## Wrong

    `P1.mark1`, `P1.outer`, `P2.mark1`, `P2.outer`, with `scope: sheet`.

    ## Right

    `P1.mark1`, `P2.mark1`, `P1.outer`, `P2.outer`.
    """

    id = "marks-first"
    sentence = "Marks are made before anything is cut through."
    source = "plant practice"
    Options = MarksFirstOptions
    strengths = ("hard", "off")

    def statements(self, facts: Facts, options: MarksFirstOptions) -> Iterator[Contiguous | Precede]:
        index = facts.nest.index
        if options.scope == "part":
            for part in facts.nest.parts:
                for mark in part.marks:
                    for cut in (*part.slits, *part.holes, part.outer):
                        sentence = f"{mark.id} is made before {cut.id}: {WHY}"
                        yield Precede(index[mark.id], index[cut.id], self.about((mark.id, cut.id), sentence))
            return
        marks = [k for k, c in enumerate(facts.nest.contours) if c.kind == "mark"]
        if not marks:
            return
        # One run of all marks, with one of them before every cut, says that every mark is, in far fewer statements.
        ids = [facts.nest.contours[k].id for k in marks]
        if len(marks) > 1:
            yield Contiguous(tuple(marks), self.about(ids, f"{ids[0]} and all other marks are made in one run: {WHY}"))
        for k, cut in enumerate(facts.nest.contours):
            if cut.kind != "mark":
                sentence = f"{cut.id} is cut after {ids[0]} and all other marks: {WHY}"
                yield Precede(marks[0], k, self.about((ids[0], cut.id), sentence))

    def violations(self, nest: Nest, cuts: CutSequence, options: MarksFirstOptions) -> list[Violation]:
        found = []
        first_cut: dict[str, tuple[int, str]] = {}
        for k, cut in enumerate(cuts.new, cuts.made + 1):
            contour = nest.contour(cut.contour)
            reach = contour.part if options.scope == "part" else ""
            if contour.kind != "mark":
                first_cut.setdefault(reach, (k, contour.id))
            elif reach in first_cut:
                earlier, name = first_cut[reach]
                text = f"{contour.id} (cut {k}) must be made before {name} (cut {earlier}): {WHY}"
                found.append(Violation(self.id, (contour.id, name), text, (earlier, k)))
        return found

    def pairs(self, nest: Nest, cuts: CutSequence, options: MarksFirstOptions) -> list[Ids]:
        if options.scope == "part":
            return [
                (mark.id, cut.id)
                for part in nest.parts
                for mark in part.marks
                for cut in (*part.slits, *part.holes, part.outer)
            ]
        marks = _marks(nest)[:1]  # the others come with it: they are one run
        return [(mark, c.id) for mark in marks for c in nest.contours if c.kind != "mark"]

    def together(self, nest: Nest, options: MarksFirstOptions) -> list[tuple[str, ...]]:
        marks = _marks(nest)
        return [marks] if options.scope == "sheet" and len(marks) > 1 else []


def _marks(nest: Nest) -> tuple[str, ...]:
    return tuple(c.id for c in nest.contours if c.kind == "mark")
