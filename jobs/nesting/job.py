"""The job: parts are laid, the nests are checked, and where cutting is to be cheap several are planned and weighed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.given import Tell
from kerfwise.jobs.listening import Listener, Listeners
from kerfwise.nesting.rounds import Effort
from kerfwise.nesting.wanted import Spacing, Wanted
from kerfwise.rules.profile.profile import Profile

from .engines import Engine, ranked_layouts, varied_layouts
from .run import Nested, expect_room, nests_from
from .spacing import with_held
from .watching import Watching
from .weigh import Weighed, alike, cheapest, weigh

Purpose = Literal["density", "cutting"]
PURPOSES: tuple[Purpose, ...] = get_args(Purpose)
WEIGHED, WEIGH_WORK = 4, 2.0
"""How many layouts are weighed, and the limit of each plan, where nobody says otherwise."""
NOTHING_LAID = "interrupted before a part was laid: nothing was written"


@dataclass(frozen=True, eq=False, slots=True)
class Asked:
    """What is to be laid, how, and what for; `most` layouts are weighed, each sheet planned within `work`."""

    plant: Profile
    wanted: Wanted
    spacing: Spacing
    effort: Effort
    engine: Engine = "own"
    purpose: Purpose = "density"
    most: int = WEIGHED
    work: float = WEIGH_WORK


@dataclass(frozen=True, eq=False, slots=True)
class Found:
    """The nests that are to be written, what was weighed to choose them, and whether somebody ended the look."""

    nested: Nested
    weighed: tuple[Weighed, ...] = ()
    interrupted: bool = False

    @property
    def taken(self) -> Weighed | None:
        """What was weighed and taken; None where nothing was weighed."""
        return next((one for one in self.weighed if one.nested is self.nested), None)


def find_nests(asked: Asked, watching: Watching, listener: Callable[[str], Listener], tell: Tell) -> Found:
    """Lay the parts, and weigh layouts for cutting where that is asked for.

    Raises
    ------
    InputError
        If a part fits on no sheet, or the check refuses the nests; where several are weighed, all of them.
    KeyboardInterrupt
        If somebody ended the look before a part was laid.
    """
    order = with_held(asked.wanted, asked.plant), asked.spacing, asked.effort, asked.engine, watching, tell
    with watching:
        expect_room(asked.wanted, asked.spacing)
        groups = varied_layouts(*order) if asked.purpose == "cutting" else [ranked_layouts(*order)]
    best = min((group[0] for group in groups if group), key=lambda layout: layout.score, default=None)
    if best is None or (watching.stopped and not best.sheets):
        raise KeyboardInterrupt(NOTHING_LAID)
    if asked.purpose == "density" or watching.stopped:
        return Found(_sound(nests_from(best)), interrupted=watching.stopped)
    weighed: list[Weighed] = []
    heard = Listeners(listener)
    for layout in alike(groups, asked.most):
        if heard.interrupted:
            break
        weighed.append(weigh(nests_from(layout), asked.plant, asked.work, heard))
    return Found(_sound(cheapest(weighed).nested), tuple(weighed), heard.interrupted)


def _sound(nested: Nested) -> Nested:
    if nested.faults:
        raise InputError("the check refuses these nests; nothing was written", details=nested.faults)
    return nested
