"""How much heat goes into each zone of a sequence of cuts, as the judging of zone-order sees it: by their own times."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest

from .placement import host_holes

ALLOWANCE = 1e-3
"""Share of a budget that may be passed: plans state times to a millisecond, programs feeds to a few digits."""
J_PER_KJ = 1000.0


@dataclass(frozen=True, slots=True)
class HotZone:
    """A zone that takes up more than its budget: its cuts (positions from 1), and the parts that may be told apart.

    Those are the outer contours straight on the sheet: what is nested in a part shares its zone.
    """

    zone: int
    heat_kj: float
    cuts: tuple[int, ...]
    outers: tuple[str, ...]


def hot_zones(nest: Nest, cuts: CutSequence, absorbed_power_w: float, budget_kj: float) -> Iterator[HotZone]:
    """The zones whose cuts, while the torch is on, leave more heat in the sheet than the budget.

    Marks leave none, and scrap lines, which are cut when all parts are out, are not asked about.
    """
    members: dict[int, list[int]] = defaultdict(list)
    for k, cut in enumerate(cuts.new, cuts.made + 1):
        if cut.zone and nest.contour(cut.contour).shapes_part:
            members[cut.zone].append(k)
    for zone, positions in sorted(members.items()):
        on_s = sum(cuts[k - 1].end_s - cuts[k - 1].start_s for k in positions)
        heat_kj = absorbed_power_w * on_s / J_PER_KJ
        if heat_kj > budget_kj * (1 + ALLOWANCE):
            outers = dict.fromkeys(_outermost(nest, cuts[k - 1].contour) for k in positions)
            yield HotZone(zone, heat_kj, tuple(positions), tuple(outers))


def _outermost(nest: Nest, contour: str) -> str:
    """The outer contour straight on the sheet that a contour lies in."""
    hosts, part = host_holes(nest), nest.contour(contour).part
    while part in hosts:
        part = hosts[part].part
    return nest.part_of[part].outer.id
