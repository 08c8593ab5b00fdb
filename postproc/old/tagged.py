"""What each burn of a program goes round: nothing for a mark, one contour mostly, several where the torch stays on."""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import dataclass

from kerfwise.postproc.check.reader.program import Burn

from .loops import OPEN, NoRound, Round, rounds_of
from .open_rounds import round_up_to_tab
from .unclear import Unclear

_TABS = "if it stops before a tab, have the profile ask for tabs"


@dataclass(frozen=True, eq=False, slots=True)
class Tagged:
    """One thing that a burn cuts: the number of the burn, and a round of it; marks have none."""

    number: int
    burn: Burn
    round: Round | None


def tagged(burns: Sequence[Burn], tab_mm: float, aside: Set[int]) -> tuple[list[Tagged], list[Unclear]]:
    """What all burns cut, in order, and those of which nobody can say it.

    A burn that stops no more than `tab_mm` short of where it joined has left a tab there; 0 where there are none. Burns
    of the lines `aside` are not looked at.
    """
    found: list[Tagged] = []
    unclear: list[Unclear] = []
    for number, burn in enumerate(burns):
        if burn.line in aside:
            continue
        try:
            found += [Tagged(number, burn, one) for one in (_rounds(burn, tab_mm) if burn.tool == 0 else (None,))]
        except NoRound as why:
            hint = f" ({_TABS})" if str(why) == OPEN and not tab_mm else ""
            unclear.append(Unclear(burn.line, f"{why}{hint}"))
    return found, unclear


def _rounds(burn: Burn, tab_mm: float) -> tuple[Round, ...]:
    try:
        return rounds_of(burn.path)
    except NoRound as why:
        if str(why) != OPEN or not tab_mm or burn.unlit:
            raise
        return (round_up_to_tab(burn.path, tab_mm),)
