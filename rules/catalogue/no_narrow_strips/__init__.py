"""Rule no-narrow-strips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.display import first_and_last
from kerfwise.encoder.nest import Nest
from kerfwise.rules.options.kind import Number
from kerfwise.rules.options.option import setting
from kerfwise.rules.options.quantities import LENGTH, likely
from kerfwise.rules.rule import Forced, NoGoodIds, Rule, Violation
from kerfwise.rules.statements import Statement

from .strips import Cutting, strips_and_islands

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


@dataclass(frozen=True, slots=True)
class NoNarrowStripsOptions:
    """What is narrow; `web_mm` is that of part-rigidity, `thickness_mm` the sheet's."""

    strip_mm: float = setting(60.0, likely(LENGTH, 0.0, 10_000.0), "metal narrower than this is a strip")
    strip_thicknesses: float = setting(
        3.0, Number(0, 1000), "and so is metal narrower than this many thicknesses of the sheet"
    )
    web_mm: float = 25.0
    thickness_mm: float = 6.0

    @property
    def narrow_mm(self) -> float:
        """The width under which metal is a strip."""
        return max(self.strip_mm, self.strip_thicknesses * self.thickness_mm)


class NoNarrowStrips(Rule[NoNarrowStripsOptions]):
    """No part is left in a narrow strip of metal between parts that are out.

    ## What it does

    Uncut metal is the sheet less every part that is out, grown by half the `web` of part-rigidity, so that the web
    between two parts that are out is gone with them. A part is in a strip when most of its area lies in metal narrower
    than `strip` (or than `strip_thicknesses` times the sheet's thickness), and parts that are out take this metal away
    on two sides, more than a right angle apart. A part is on an island when a piece of metal no wider than ten strips
    is cut off from the rest, and parts are left on both: those on the side with fewer of them are left behind. Each
    part is named once. Parts in the same place are looked at together: on the sheet, or in one hole.

    Nothing of this can be stated before there is an order: orders are checked, and what is found comes back as sets of
    parts that must not be out while others are in. Where orders that may not be broken leave no other way, a plan under
    the hard rule excuses a part, in as few places as can be, and says so: in its list of exceptions and in the program,
    as `(EXCUSED no-narrow-strips P1.outer)`.

    ## Links, tabs and other cuts

    - **Links**: What a link burns of the metal is not looked at.
    - **Tabs**: They change nothing: they hold a part once it is cut, and the rule is about metal that is not cut yet.
    - **Common cuts**: They change nothing: a part is out when its own cut is made.
    - **Scrap lines**: Nothing is asked of them: no part is left when they are cut.

    ## Why

    Petunin 2009 (fig. 3): a narrow strip left between two openings bends with the heat of the next cuts, and the parts
    in it are bent with it.

    ## Wrong

    Three long parts side by side: the two outer ones first, then the one between them.

    ## Right

    The same parts one after the other, from one side to the other.
    """

    id = "no-narrow-strips"
    sentence = "No part is left in a narrow strip of metal between parts that are out."
    source = "Petunin 2009, fig. 3"
    Options = NoNarrowStripsOptions
    takes_no_file = "strips are found in whole orders; nothing can be stated of them beforehand"
    minds_what_is_out = True
    default = "soft"
    default_weight = 250.0
    excusable = True

    def statements(self, facts: Facts, options: NoNarrowStripsOptions) -> Sequence[Statement]:
        return ()

    def no_goods(self, nest: Nest, order: Sequence[str], options: NoNarrowStripsOptions) -> list[NoGoodIds]:
        found = []
        for cutting in strips_and_islands(nest, tuple(order), options.narrow_mm, options.web_mm):
            out = tuple(nest.parts[k].outer.id for k in cutting.out)
            left = tuple(nest.parts[k].outer.id for k in cutting.left)
            last = f"the last of {first_and_last(out, 4)}"
            sentence = f"{' or '.join(left)} is cut before {last}: {_where(cutting, left, 'them')}"
            found.append(NoGoodIds(out, left, sentence))
        return found

    def violations(self, nest: Nest, cuts: CutSequence, options: NoNarrowStripsOptions) -> list[Violation]:
        at = cuts.positions()
        order = tuple(cut.contour for cut in cuts)
        found = []
        for cutting in strips_and_islands(nest, order, options.narrow_mm, options.web_mm):
            if cutting.k <= cuts.made:
                continue
            left = tuple(nest.parts[k].outer.id for k in cutting.left)
            out = sorted((nest.parts[k].outer.id for k in cutting.out), key=at.__getitem__)
            text = f"after {order[cutting.k - 1]} (cut {cutting.k}) {_where(cutting, left, first_and_last(out, 4))}"
            found.append(Violation(self.id, (left[0],), text, tuple(at[name] for name in out)))
        return found

    def excuse(
        self, nest: Nest, cuts: CutSequence, options: NoNarrowStripsOptions, violation: Violation, forced: Forced
    ) -> str | None:
        (name,) = violation.contours
        cut = next((cut for cut in cuts if cut.contour == name), None)
        if cut is None or self.id not in cut.excused:
            return None
        out = frozenset(cuts[k - 1].contour for k in violation.cuts)
        if out <= forced(name):
            earlier = first_and_last(sorted(out), 4)
            return f"within these zones no order avoids it: the order rules put {earlier} before {name}"
        return f"the plan excuses it: what must be cut before {name} left nothing better"


def _where(cutting: Cutting, left: Sequence[str], out: str) -> str:
    if cutting.kind == "strip":
        return f"{left[0]} lies in a narrow strip between {out}"
    return f"{left[0]} lies on an island, cut off from {left[1]} by {out}"
