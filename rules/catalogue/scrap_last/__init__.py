"""Rule scrap-last."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Ids, Nest
from kerfwise.rules.judging.holding import loose_scrap_cuts
from kerfwise.rules.rule import Rule, Strength, Violation
from kerfwise.rules.statements import AtLeast, Before, Contiguous, Precede

from .skeleton import skeleton_of

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import FactOptions, Facts

WHY = "cutting up the skeleton takes away what holds it"


@dataclass(frozen=True, slots=True)
class ScrapLastOptions:
    """What a cut burns away, of the profile."""

    kerf_mm: float = 1.5


class ScrapLast(Rule[ScrapLastOptions]):
    """The skeleton is cut up when all parts are out, from the outside in.

    ## What it does

    Scrap lines are cut after every contour of every part, in one run. Among themselves they are cut in an order in
    which each is cut in metal that still holds to the frame: the largest piece that all the lines together leave of
    the largest piece that the parts leave of the skeleton (of equal ones the lowest, then the leftmost). So pieces come
    off from the outside in. Stated for each line that does not bound the frame: another line that bounds the same piece
    is cut after it. Metal narrower than the kerf holds nothing: lines in such metal alone are free.

    ## Links, tabs and other cuts

    - **Links**: Where there are scrap lines there are no links: a link may cut metal off the skeleton, in which a line
      is cut afterwards.
    - **Tabs**: A part with tabs is out once it is cut, and leaves with its piece of the skeleton.
    - **Common cuts**: They change nothing: lines come when all parts are out.
    - **Scrap lines**: The rule orders them.

    ## Why

    The skeleton holds the parts until they are cut. A piece of it that is cut off lies loose on the slats; a line cut
    in it would push it about, and the torch may run into it. Common practice of plants that cut up their skeletons.

    ## Wrong

    `scrap1`, `A.outer`: A loses what holds it. Of two lines that cut off strips at the left side, the inner one first:
    the outer one is then cut in a strip that is loose.

    ## Right

    `A.outer`, then the line nearest to the side, then the next one.
    """

    id = "scrap-last"
    sentence = "The skeleton is cut up when all parts are out, from the outside in."
    source = "plant practice"
    Options = ScrapLastOptions
    strengths = ("hard", "off")
    minds_what_is_out = True

    def statements(self, facts: Facts, options: ScrapLastOptions) -> Iterator[AtLeast | Contiguous | Precede]:
        contours = facts.nest.contours
        lines = [facts.nest.index[line.id] for line in facts.nest.scrap]
        if not lines:
            return
        # One run of all lines, with one of them after every cut, says that every line is, in far fewer statements.
        ids = [contours[k].id for k in lines]
        if len(lines) > 1:
            sentence = f"{ids[0]} and all other scrap lines are cut in one run: {WHY}"
            yield Contiguous(tuple(lines), self.about(ids, sentence))
        for k, contour in enumerate(facts.nest.without_scrap.contours):
            sentence = f"{contour.id} is cut before {ids[0]} and all other scrap lines: {WHY}"
            yield Precede(k, lines[0], self.about((contour.id, ids[0]), sentence))
        framed, pairs = facts.column("scrap_framed"), facts.column("scrap_beside")
        for line in lines:
            if not framed[line]:
                beside = pairs[pairs[:, 0] == line, 1].tolist()
                names = [contours[other].id for other in beside]
                holds = f"{' or '.join(names)} is cut after {contours[line].id}" if names else "nothing can"
                sentence = f"{holds}, to hold the metal that it is cut in"
                later = tuple(Before(line, other) for other in beside)
                yield AtLeast(later, (1,) * len(later), 1, self.about((contours[line].id, *names), sentence))

    def violations(self, nest: Nest, cuts: CutSequence, options: ScrapLastOptions) -> list[Violation]:
        found = []
        first: tuple[int, str] | None = None
        for k, cut in enumerate(cuts, 1):
            if nest.contour(cut.contour).kind == "scrap":
                first = first or (k, cut.contour)
            elif first is not None:
                text = f"{cut.contour} (cut {k}) must be cut before {first[1]} (cut {first[0]}): {WHY}"
                found.append(Violation(self.id, (cut.contour, first[1]), text, (first[0], k)))
        for line, position in loose_scrap_cuts(nest, cuts, options.kerf_mm):
            text = f"{line} (cut {position}) is cut in a piece of the skeleton that is loose"
            found.append(Violation(self.id, (line,), text, (position,)))
        return found

    def fact_options(self, given: FactOptions, options: ScrapLastOptions, strength: Strength) -> FactOptions:
        return replace(given, columns=(*given.columns, skeleton_of))

    def pairs(self, nest: Nest, cuts: CutSequence, options: ScrapLastOptions) -> list[Ids]:
        # The other lines come with the first: they are one run.
        return [(c.id, line.id) for line in nest.scrap[:1] for c in nest.without_scrap.contours]

    def together(self, nest: Nest, options: ScrapLastOptions) -> list[tuple[str, ...]]:
        return [tuple(line.id for line in nest.scrap)] if len(nest.scrap) > 1 else []
