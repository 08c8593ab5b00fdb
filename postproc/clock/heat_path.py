"""A plan or a program as the timed path of a torch that heats the sheet; marks heat nothing worth speaking of."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from kerfwise.encoder.corner_feed import chords, paced
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.models.physics.heat import TimedPath, TorchOn
from kerfwise.models.physics.heat.bounds import MOST_S, expect_short
from kerfwise.models.physics.heat.timed_path import in_order, torch_on, without
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.postproc.nc.plan_paths import Toolpath, toolpaths
from kerfwise.rules.profile.profile import Profile

_CHORD_MM = 0.05
_CUT = re.compile(r"CUT \d+ (?P<contour>\S+)")


def path_of_plan(plan: Plan, nest: Nest, profile: Profile) -> TimedPath:
    """Where the torch burns by the plan, at the times that the plan states.

    Raises
    ------
    InputError
        If the plan was made from another nest, or its times are missing or contradict each other.
    """
    if plan.cuts and not any(planned.cut.end_s for planned in plan.cuts):
        raise InputError("the plan does not say when its contours are cut: start_s and end_s are needed for heat")
    law = profile.corner_feed()
    burns: list[TorchOn] = []
    pierced = plan.sequence().pierced
    for order, made in enumerate(toolpaths(plan, nest, profile), plan.resumed_after + 1):
        for pierce in pierced.get(order, ()):
            burns.append(torch_on(pierce.contour, np.array([pierce.at]), pierce.start_s, pierce.end_s))
        if made.marks:
            continue
        cut = made.planned.cut
        points, slowness = chords(made.path, paced(made.path, law), _CHORD_MM)
        burn = torch_on(cut.contour, points, cut.start_s, cut.end_s, _stands_s(made, profile), slowness)
        burns += without(burn, made.unlit)
    return in_order(burns, plan.totals.time_s)


def _stands_s(made: Toolpath, profile: Profile) -> float:
    """How long the torch burns where a cut begins."""
    if made.linked:
        return 0.0
    if made.pierced:
        return profile.machine.at_hole_s
    return profile.machine.unpierced_s if made.edge_start else profile.machine.pierce_time_s


def path_of_program(program: NcProgram, file: str | Path | None = None) -> TimedPath:
    """Where the torch burns by a program, at its own feeds and for its own waits.

    Rapids are as profiled, and so are pierces where the dialect leaves them to the machine.

    Raises
    ------
    InputError
        With file and line, for a program of more than a week: it cannot be simulated.
    """
    burns: list[TorchOn] = []
    for burn in program.burns:
        took_s = burn.end_s - burn.start_s + burn.wait_s
        if not took_s <= MOST_S:
            raise InputError(
                f"the cut that begins here takes {took_s / 3600:.4g} h with the wait before it, and heat is simulated "
                f"for programs of up to {MOST_S / 3600:g} h: correct its feed (F) and its waits (G4)",
                file=file,
                line=burn.line,
            )
        if burn.tool != 0:
            continue
        named = _CUT.search(burn.comment)
        name = named["contour"] if named else f"line {burn.line}"
        points, slowness = chords(burn.path, burn.paced, _CHORD_MM)
        stands_s = burn.held_s + burn.pierce_s
        burns += without(torch_on(name, points, burn.start_s, burn.end_s, stands_s, slowness), burn.unlit)
    path = in_order(burns, burns[-1].at_s[-1] if burns else 0.0)
    expect_short(path, file)
    return path
