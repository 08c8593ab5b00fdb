"""Rule nested-before-host-holes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from kerfwise.encoder.cut import CutSequence, Side
from kerfwise.encoder.nest import Ids, Nest
from kerfwise.rules.judging.metal import host_holes
from kerfwise.rules.options.option import NoOptions
from kerfwise.rules.rule import OrderRule
from kerfwise.rules.statements import Precede

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


class NestedBeforeHostHoles(OrderRule[NoOptions]):
    """A part that lies in a hole of a host is cut before any hole of that host.

    ## What it does

    Every part that lies straight in a hole of a host (first level) is out before the first inner contour of the host
    is cut, not only before the hole it lies in. A part is out with its outer contour, its own last cut.

    ## Links, tabs and other cuts

    - **Links**: They change no order. Parts in one hole may be linked with each other, never with the host.
    - **Tabs**: The order is kept as ever: a part in a hole is out once it is cut, on its tabs or not.
    - **Common cuts**: They change no order. Parts in one hole may have edges in common with each other.
    - **Scrap lines**: Nothing is asked of them: none lies in a hole of a part.

    ## Why

    Verkhoturov et al., restriction 2: the host is still whole, and so stiff, while the parts inside it are cut, and
    its own contours can then follow each other without a break (rule part-contiguous). It is never dropped.

    ## Wrong

    `P1.hole1`, `P2.outer`, `P1.hole2`, `P1.outer`, where P2 lies in P1.hole2.

    ## Right

    `P2.outer`, `P1.hole1`, `P1.hole2`, `P1.outer`.
    """

    id = "nested-before-host-holes"
    sentence = "A part that lies in a hole of a host is cut before any hole of that host."
    source = "Verkhoturov et al., restriction 2"
    Options = NoOptions

    def statements(self, facts: Facts, options: NoOptions) -> Iterator[Precede]:
        contours, index = facts.nest.contours, facts.nest.index
        for guest, hole in enumerate(facts.parent.tolist()):
            if hole >= 0 and contours[guest].kind == "outer":
                for host_hole in facts.nest.part_of[contours[hole].part].holes:
                    yield self.precede(facts, guest, index[host_hole.id])

    def pairs(self, nest: Nest, cuts: CutSequence, options: NoOptions) -> list[Ids]:
        return [
            (nest.part_of[guest].outer.id, host_hole.id)
            for guest, hole in host_holes(nest).items()
            for host_hole in nest.part_of[hole.part].holes
        ]

    def reason(self, before: str, after: str, start_side: Side | None) -> str:
        host = after.rpartition(".")[0]
        return f"it is nested in {host}, and all parts in there are cut before the first hole of {host}"
