"""Rule cut-direction."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, cast

from kerfwise.encoder.cut import CutSequence, Direction
from kerfwise.encoder.nest import Kind, Nest
from kerfwise.rules.options.kind import Choice
from kerfwise.rules.options.option import setting
from kerfwise.rules.rule import Rule, Strength, Violation
from kerfwise.rules.statements import Forbid

if TYPE_CHECKING:
    from kerfwise.encoder.candidates.candidate import LeadOptions
    from kerfwise.encoder.facts.facts import Facts

WayRound = Literal["free", "cw", "ccw"]
WAYS = Choice(("free", "cw", "ccw"))
SPOKEN: dict[Direction, str] = {"cw": "clockwise", "ccw": "counter-clockwise"}


@dataclass(frozen=True, slots=True)
class CutDirectionOptions:
    """Which way round each kind of contour is cut."""

    outer: WayRound = setting("free", WAYS, "direction of outer contours")
    hole: WayRound = setting("free", WAYS, "direction of holes")
    mark: WayRound = setting("free", WAYS, "direction of marks (of an open one: ccw is along the line as drawn)")

    def allowed(self, kind: Kind) -> tuple[Direction, ...]:
        """The directions that a kind of contour may be cut in."""
        if kind in ("slit", "scrap", "stretch"):  # along its line, by its candidates
            return ("cw", "ccw")
        way = cast(WayRound, getattr(self, kind))
        return ("cw", "ccw") if way == "free" else (way,)


class CutDirection(Rule[CutDirectionOptions]):
    """Contours are cut in the direction that the process asks of their kind.

    ## What it does

    For each kind of contour (outer, hole, mark) the profile leaves the direction free or fixes it. Directions are as
    seen from above with y up.

    ## Links, tabs and other cuts

    - **Links**: A link leads to a contour by one of its lawful ways round, and changes none.
    - **Tabs**: They change nothing: a ring with gaps is still cut one way round.
    - **Common cuts**: A shared edge has its good side on one part only. Where the rule is hard for outer contours they
      are refused, unless the profile accepts that (`cuts: {common: {good_side: any}}`).
    - **Scrap lines**: They have no side of their own, and may be cut from either end.

    ## Why

    A plasma arc swirls: one side of the kerf comes out square, the other bevelled. Outer contours clockwise and holes
    counter-clockwise put the square side on the part.

    ## Wrong

    `outer: cw`, and `P1.outer` cut counter-clockwise.

    ## Right

    `outer: cw`, and `P1.outer` cut clockwise.
    """

    id = "cut-direction"
    sentence = "Contours are cut in the direction that the process asks of their kind."
    source = "plasma practice (swirl of the arc)"
    Options = CutDirectionOptions
    minds_ways = True

    def statements(self, facts: Facts, options: CutDirectionOptions) -> Iterator[Forbid]:
        for number, candidate in enumerate(facts.candidates):
            contour = facts.nest.contours[candidate.contour]
            if candidate.direction not in (allowed := options.allowed(contour.kind)):
                sentence = f"{contour.id} is cut {SPOKEN[allowed[0]]}: that is the direction of every {contour.kind}"
                yield Forbid(number, self.about((contour.id,), sentence))
            for stretch in contour.along:
                way = stretch if candidate.direction == "ccw" else stretch.reversed
                if way.direction not in (allowed := options.allowed("outer")):
                    sentence = f"{stretch.contour} is begun {SPOKEN[allowed[0]]}: that is the direction of every outer"
                    yield Forbid(number, self.about((contour.id, stretch.contour), sentence))

    def lead_options(self, given: LeadOptions, options: CutDirectionOptions, strength: Strength) -> LeadOptions:
        if strength != "hard":
            return given
        return replace(given, directions={kind: options.allowed(kind) for kind in given.directions})

    def violations(self, nest: Nest, cuts: CutSequence, options: CutDirectionOptions) -> list[Violation]:
        found = []
        for k, cut in cuts.burns:
            contour = nest.contour(cut.contour)
            if cut.direction not in (allowed := options.allowed(contour.kind)):
                place = f"cut {k}" if cuts.finishes(k, cut) else f"begun before cut {k}"
                text = (
                    f"{contour.id} ({place}) is cut {SPOKEN[cut.direction]}; the direction of every {contour.kind} is "
                    f"{SPOKEN[allowed[0]]}"
                )
                found.append(Violation(self.id, (contour.id,), text, (k,)))
        return found
