"""Rule inner-before-outer."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from kerfwise.encoder.cut import CutSequence, Side
from kerfwise.encoder.nest import Ids, Nest
from kerfwise.rules.judging.metal import host_holes
from kerfwise.rules.options.option import NoOptions
from kerfwise.rules.rule import OrderRule, Strength
from kerfwise.rules.statements import Precede

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import FactOptions, Facts


class InnerBeforeOuter(OrderRule[NoOptions]):
    """Every contour that lies inside another is cut before it.

    ## What it does

    The holes, marks and slits of a part come before its outer contour; a part that lies in a hole of another comes
    before that hole, and a slit before the contour that its slot is of. It is stated for each contour and the one
    immediately around it; the rest follows.

    ## Links, tabs and other cuts

    - **Links**: They change no order: a hole is never linked, and a link leads to an outer contour when its holes are
      out.
    - **Tabs**: The order is kept as ever: a part on its tabs may move a little.
    - **Common cuts**: A hole comes before the cut that takes its part out. A neighbour's cut may have followed a
      shared edge before.
    - **Scrap lines**: They lie in no part, and no part lies in them.

    ## Why

    Cutting a contour frees the metal inside it: a contour cut there afterwards is cut in a piece that has fallen or
    moved. Pristupov 2016 (fig. 1) and Verkhoturov et al. (restriction 1) ask it of every plan; it is never dropped.

    ## Wrong

    `P1.outer`, `P1.hole1`: the hole is cut in a part that is loose.

    ## Right

    `P1.hole1`, `P1.outer`.
    """

    id = "inner-before-outer"
    pairs_are = "parent"
    sentence = "Every contour that lies inside another is cut before it."
    source = "Pristupov 2016, fig. 1; Verkhoturov et al., restriction 1"
    Options = NoOptions
    of_fallen_metal = True

    def statements(self, facts: Facts, options: NoOptions) -> Iterator[Precede]:
        for contour, around in enumerate(facts.parent.tolist()):
            if around >= 0:
                yield self.precede(facts, contour, around)

    def fact_options(self, given: FactOptions, options: NoOptions, strength: Strength) -> FactOptions:
        return replace(given, zone_respects=given.zone_respects | {"contains"}) if strength == "hard" else given

    def pairs(self, nest: Nest, cuts: CutSequence, options: NoOptions) -> list[Ids]:
        within_part = [(c.id, part.outer.id) for part in nest.parts for c in (*part.marks, *part.holes)]
        within_part += [(slit.id, slit.slot_of) for part in nest.parts for slit in part.slits]
        nested = [(nest.part_of[guest].outer.id, hole.id) for guest, hole in host_holes(nest).items()]
        return within_part + nested

    def reason(self, before: str, after: str, start_side: Side | None) -> str:
        if before.rpartition(".")[2].startswith("slit"):
            return f"it opens a slot beside metal that cutting {after} frees"
        return f"it lies inside it, and cutting {after} frees the metal it is in"
