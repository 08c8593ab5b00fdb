"""Rule part-contiguous."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.display import first_and_last
from kerfwise.encoder.nest import Contour, Ids, Nest, Part
from kerfwise.rules.catalogue.marks_first import MarksFirst, MarksFirstOptions
from kerfwise.rules.expression.over_cuts import interrupted
from kerfwise.rules.options.kind import Choice
from kerfwise.rules.options.option import setting
from kerfwise.rules.rule import Plant, Rule, RuleSetting, Strength, Violation
from kerfwise.rules.statements import Contiguous, Precede

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import FactOptions, Facts


@dataclass(frozen=True, slots=True)
class PartContiguousOptions:
    """What belongs to the run of a part."""

    marks: Literal["apart", "together"] = setting(
        "apart", Choice(("apart", "together")), "whether a part's marks belong to its run of cuts"
    )


class PartContiguous(Rule[PartContiguousOptions]):
    """The holes of a part and then its outer contour follow each other without another contour between.

    ## What it does

    A part is cut in one go: its holes and slits in any order, its outer contour last, and no contour of another part in
    between. Marks are left out unless `marks: together` (which needs `marks-first: {scope: part}`). What is left of a
    part when a program goes on after a stop is cut in one go as well, whenever its turn comes.

    ## Links, tabs and other cuts

    - **Links**: No link leads to a part with holes while the rule is hard: its holes come first.
    - **Tabs**: They change nothing.
    - **Common cuts**: The run of a part ends with its own cut, whatever its neighbours have cut of its outline
      before.
    - **Scrap lines**: They belong to no part, so that each is alone. They are a run of their own by scrap-last.
    - **Several torches**: What they cut at one time comes between nothing.

    ## Why

    Verkhoturov et al., restriction 1: holes keep their place relative to the outline when the sheet has no time to
    move in between. A plant may switch it off for thermal reasons: it puts much heat in one place.

    ## Wrong

    `P1.hole1`, `P2.outer`, `P1.outer`.

    ## Right

    `P2.outer`, `P1.hole1`, `P1.outer`.
    """

    id = "part-contiguous"
    sentence = "The holes of a part and then its outer contour follow each other without another contour between."
    source = "Verkhoturov et al., restriction 1"
    Options = PartContiguousOptions

    def statements(self, facts: Facts, options: PartContiguousOptions) -> Iterator[Contiguous | Precede]:
        index = facts.nest.index
        for part in facts.nest.parts:
            run = _run(part, options)
            if len(run) < 2:
                continue
            ids = [c.id for c in run]
            yield Contiguous(
                tuple(index[name] for name in ids),
                self.about(ids, f"{part.id} is cut in one go: {first_and_last(ids)} follow each other"),
            )
            for contour in run[:-1]:
                reason = f"{part.outer.id} is the last cut of {part.id}"
                about = self.about((contour.id, part.outer.id), f"{contour.id} is cut before {part.outer.id}: {reason}")
                yield Precede(index[contour.id], index[part.outer.id], about)

    def fact_options(self, given: FactOptions, options: PartContiguousOptions, strength: Strength) -> FactOptions:
        return replace(given, parts_in_one_go=strength == "hard")

    def check_with(
        self, options: PartContiguousOptions, plant: Plant, rules: Mapping[str, RuleSetting]
    ) -> Iterator[tuple[str, str]]:
        first = rules[MarksFirst.id]
        assert isinstance(first.options, MarksFirstOptions)
        if first.strength != "off" and first.options.scope == "sheet" and options.marks == "together":
            yield (
                "marks",
                "marks cannot stay with their part while marks-first puts all marks of the sheet first; say marks: "
                "apart, or marks-first: {scope: part}",
            )

    def pairs(self, nest: Nest, cuts: CutSequence, options: PartContiguousOptions) -> list[Ids]:
        return [(c.id, part.outer.id) for part in nest.parts for c in _run(part, options)[:-1]]

    def together(self, nest: Nest, options: PartContiguousOptions) -> list[tuple[str, ...]]:
        return [tuple(c.id for c in _run(part, options)) for part in nest.parts]

    def violations(self, nest: Nest, cuts: CutSequence, options: PartContiguousOptions) -> list[Violation]:
        at, when = cuts.positions(), cuts.moments()
        found = []
        for part in nest.parts:
            run = [c.id for c in _run(part, options)]
            own = sorted(at[name] for name in run if at.get(name, 0) > cuts.made)
            if len(own) < 2:
                continue
            if (breach := interrupted(run, cuts, at, when)) is not None:
                ids, text, positions = breach
                found.append(Violation(self.id, ids, f"{part.id} is not cut in one go: {text}", positions))
            last = cuts[own[-1] - 1].contour
            if at.get(part.outer.id, 0) > cuts.made and last != part.outer.id:
                outer_at = at[part.outer.id]
                text = f"{part.outer.id} (cut {outer_at}) is not the last of {part.id}: {last} (cut {own[-1]}) follows"
                found.append(Violation(self.id, (part.outer.id, last), text, (outer_at, own[-1])))
        return found


def _run(part: Part, options: PartContiguousOptions) -> tuple[Contour, ...]:
    """The contours of a part that follow each other, its outer contour last."""
    marks = part.marks if options.marks == "together" else ()
    return (*marks, *part.slits, *part.holes, part.outer)
