"""Rule no-islands."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.display import first_and_last
from kerfwise.encoder.nest import Nest
from kerfwise.rules.judging.holding import clusters, holding, island_cuts
from kerfwise.rules.options.kind import Number
from kerfwise.rules.options.option import setting
from kerfwise.rules.rule import Forced, Rule, Violation
from kerfwise.rules.statements import AtLeast, Before, Literal

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

ALLOWANCE = 0.05
"""How far under `frame_share` the judged share may be: facts see the boundary in cells, the judging sees it finer."""
NEAR_MM = 0.5
"""How much further than the web the judging looks: in other steps than the facts it may miss where two are nearest."""


@dataclass(frozen=True, slots=True)
class NoIslandsOptions:
    """What holds uncut parts together; the bands are those of part-rigidity and start-side."""

    frame_share: float = setting(
        0.1, Number(0, 1), "a part hangs on the frame if this much of its contour faces solid metal or the sheet's edge"
    )
    web_mm: float = 25.0
    edge_band_mm: float = 25.0


class NoIslands(Rule[NoIslandsOptions]):
    """The parts that are still in hold together at every moment.

    ## What it does

    Two parts in the same place (straight on the sheet, or in the same hole) hang together if one faces the other
    within the `web` of part-rigidity. A part hangs on the frame, which is never cut, if at least `frame_share` of its
    outer contour faces solid metal or the strip of sheet along the edge; a part inside a hole hangs on its host, which
    is cut after it. Of parts that hang together at the start, every one but the last must leave one behind that it
    hangs on, or hang on the frame. What hangs together and on no frame ends with any of its parts. The check allows
    0.05 less than `frame_share`, and looks 0.5 mm further than the web, for it looks at the boundary in other steps
    than the facts; a part that a plan excuses is told among the excuses all the same.

    Where orders that may not be broken leave no other way, a plan under the hard rule excuses a part that hangs on
    nothing any more, in as few places as can be, and says so: in its list of exceptions and in the program, as
    `(EXCUSED no-islands P1.outer)`.

    ## Links, tabs and other cuts

    - **Links**: What a link burns of the skeleton is not looked at.
    - **Tabs**: They change nothing: they hold a part once it is cut, and the rule is about metal that is not cut yet.
    - **Common cuts**: A kerf of metal lies between two parts with a common edge: while both are in they hold each
      other.
    - **Scrap lines**: Nothing is asked of them: no part is left when they are cut.

    ## Why

    Pristupov 2016 and Petunin 2009: uncut parts behind the torch, held by nothing but webs to parts already out, sag,
    shift and take the torch with them. That an edge strip counts as frame is a choice: it is thin, but in one piece.

    ## Wrong

    Three rows of parts, and the middle part is left for last: its neighbours all around are out.

    ## Right

    The same rows, cut from one side of the sheet to the other.
    """

    id = "no-islands"
    sentence = "The parts that are still in hold together at every moment."
    source = "Petunin 2009; Pristupov 2016"
    Options = NoIslandsOptions
    minds_what_is_out = True
    default = "soft"
    default_weight = 250.0
    excusable = True

    def statements(self, facts: Facts, options: NoIslandsOptions) -> Iterator[AtLeast]:
        joined, framed = _holding_facts(facts, options.frame_share)
        for cluster in clusters(joined):
            anchored = any(i in framed for i in cluster)
            for i in cluster:
                if i in framed or len(cluster) == 1:
                    continue
                name = facts.nest.contours[i].id
                stays = sorted(joined[i])
                ids = (name, *(facts.nest.contours[x].id for x in stays))
                held_by = first_and_last(ids[1:], 4)
                about = self.about(ids, f"{name} is cut while any of {held_by} is still in, to hold it")
                literals: list[Literal] = [Before(i, x) for x in stays]
                weights, bound = [1] * len(stays), 1
                if not anchored:  # or all others of the cluster are out: then it is the last
                    bound = len(cluster) - 1
                    weights = [bound] * len(stays)
                    others = [x for x in cluster if x != i]
                    literals += [Before(x, i) for x in others]
                    weights += [1] * len(others)
                yield AtLeast(tuple(literals), tuple(weights), bound, about)

    def violations(self, nest: Nest, cuts: CutSequence, options: NoIslandsOptions) -> list[Violation]:
        web_mm, share = options.web_mm + NEAR_MM, options.frame_share - ALLOWANCE
        joined, framed = holding(nest, web_mm, options.edge_band_mm, share)
        number = {part.outer.id: k for k, part in enumerate(nest.parts)}
        at = {number[cut.contour]: k for k, cut in enumerate(cuts, 1) if cut.contour in number}
        found = []
        for cluster in clusters(joined):
            for k, island in island_cuts(cluster, joined, framed, at):
                names = tuple(nest.parts[part].outer.id for part in island)
                left = first_and_last(names, 4)
                text = f"{cuts[k - 1].contour} (cut {k}) leaves {left} on an island that nothing still in holds"
                found.append(Violation(self.id, names, text, (k,)))
        ends = {max(violation.contours, key=lambda name: at.get(number[name], len(cuts) + 1)) for violation in found}
        found += self._excused_as_well(nest, cuts, options, ends)
        return sorted(found, key=lambda violation: violation.cuts)

    def _excused_as_well(
        self, nest: Nest, cuts: CutSequence, options: NoIslandsOptions, known: Collection[str]
    ) -> Iterator[Violation]:
        """Parts that a plan excuses beside those `known`: the planner has seen less that holds them than the judging.

        They are told where nothing holds them by a web as much narrower, and a share as much greater.
        """
        outers = {part.outer.id: k for k, part in enumerate(nest.parts)}
        asked = [cut.contour for cut in cuts if self.id in cut.excused and cut.contour in outers]
        if not (asked := [name for name in asked if name not in known]):
            return
        web_mm, share = max(options.web_mm - NEAR_MM, 0.0), min(options.frame_share + ALLOWANCE, 1.0)
        joined, framed = holding(nest, web_mm, options.edge_band_mm, share)
        at = cuts.positions()
        for name in asked:
            gone = all(at.get(nest.parts[x].outer.id, len(cuts) + 1) < at[name] for x in joined[outers[name]])
            if gone and outers[name] not in framed:
                text = f"{name} (cut {at[name]}) is cut with nothing, or next to nothing, still in that holds it"
                yield Violation(self.id, (name,), text, (at[name],))

    def allowances(self, options: NoIslandsOptions) -> tuple[NoIslandsOptions, ...]:
        shares = (min(options.frame_share + share, 1.0) + ALLOWANCE for share in (-ALLOWANCE, ALLOWANCE))
        return tuple(replace(options, frame_share=share) for share in shares)

    def excuse(
        self, nest: Nest, cuts: CutSequence, options: NoIslandsOptions, violation: Violation, forced: Forced
    ) -> str | None:
        at = cuts.positions()
        last = max(violation.contours, key=lambda name: at.get(name, len(cuts) + 1))
        if last not in at or self.id not in cuts[at[last] - 1].excused:
            return None
        joined, _ = holding(nest, options.web_mm, options.edge_band_mm, options.frame_share)
        number = next(k for k, part in enumerate(nest.parts) if part.outer.id == last)
        if {nest.parts[k].outer.id for k in joined[number]} <= forced(last):
            return (
                f"within these zones no order avoids it: the order rules put everything that {last} hangs on before it"
            )
        return f"the plan excuses it: what must be cut before {last} left nothing to hold it"


def _holding_facts(facts: Facts, frame_share: float) -> tuple[dict[int, set[int]], set[int]]:
    """Which outer contours hang together, and which on the frame, from facts."""
    nest, faced = facts.nest, facts.neighbours
    place = facts.parent
    joined: dict[int, set[int]] = {nest.index[part.outer.id]: set() for part in nest.parts}
    framed: set[int] = set()
    for i, x in zip(faced.row.tolist(), faced.neighbour.tolist(), strict=True):
        if place[i] == place[x]:
            joined[i].add(x)
            joined[x].add(i)
        else:
            framed.add(i)
    for i in joined:
        rest_mm = facts.edge_length_mm[i].sum() + facts.solid_mm[i]
        if rest_mm >= frame_share * nest.contours[i].curve.length_mm - 1e-6:
            framed.add(i)
    return joined, framed
