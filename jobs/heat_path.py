"""Where and when the torch burns by a plan or a program: the timed path that heats the sheet; marks heat nothing."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.bevels.cut_nest import bevelled
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.torch_path import chords, paced
from kerfwise.models.physics.heat import TimedPath, TorchOn
from kerfwise.models.physics.heat.simulate import MOST_S, expect_short
from kerfwise.models.physics.heat.timed_path import in_order, torch_on, without_tabs
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import expect_plan_of, read_plan
from kerfwise.postproc.check.jets import jet_of
from kerfwise.postproc.check.machine_limits import stated_spacing
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.postproc.check.reader.read_program import Trusted
from kerfwise.postproc.clock import read_program
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.nc.toolpaths import Toolpath, toolpaths
from kerfwise.rules.profile.plant_sections import Torches
from kerfwise.rules.profile.profile import Profile

from .inputs import Inputs, Tell, differences, is_plan_file, read_program_of

_CHORD_MM = 0.05
_CUT = re.compile(r"CUT \d+ (?P<contour>\S+)")


def path_of_plan(plan: Plan, nest: Nest, profile: Profile, along_contours: bool = False) -> TimedPath:
    """Where the torch burns by the plan, at the times that the plan states.

    Where torches lean it burns as the program of the plan does, pass after pass, or once `along_contours`. Raises
    InputError if the plan was made from another nest, or its times are missing or contradict each other.
    """
    if plan.cuts and not any(planned.cut.end_s for planned in plan.cuts):
        raise InputError("the plan does not say when its contours are cut: start_s and end_s are needed for heat")
    if not along_contours and any(planned.passes for planned in plan.cuts):
        return path_of_program(read_program(write_program(plan, nest, profile), nest, profile), None, profile)
    law = profile.corner_feed()
    burns: list[TorchOn] = []
    pierced = plan.sequence().pierced
    for order, toolpath in enumerate(toolpaths(plan, nest, profile), plan.resumed_after + 1):
        for pierce in pierced.get(order, ()):
            burns.append(torch_on(pierce.contour, np.array([pierce.at]), pierce.start_s, pierce.end_s))
        if toolpath.marks:
            continue
        cut = toolpath.planned.cut
        points, slowness = chords(toolpath.path, paced(toolpath.path, law), _CHORD_MM)
        burn = torch_on(cut.contour, points, cut.start_s, cut.end_s, _stands_s(toolpath, profile), slowness)
        for lit in without_tabs(burn, toolpath.unlit):
            burns += [lit, *(_burnt_with(lit, cut, other.cut) for other in toolpath.together)]
    try:
        return in_order(burns, plan.totals.time_s)
    except InputError as error:
        raise InputError(f"the plan is damaged: {error.message}") from None


def _stands_s(toolpath: Toolpath, profile: Profile) -> float:
    """How long the torch burns where a cut begins."""
    if toolpath.linked:
        return 0.0
    if toolpath.pierced:
        return profile.machine.at_hole_s
    return profile.machine.unpierced_s if toolpath.edge_start else profile.machine.pierce_time_s


def _burnt_with(lit: TorchOn, cut: Cut, other: Cut) -> TorchOn:
    """What another torch burns of its cut while the first one burns a stretch of this one."""
    return lit.by(other.torch, other.contour, (other.pierce[0] - cut.pierce[0], other.pierce[1] - cut.pierce[1]))


def _torches_of(program: NcProgram, profile: Profile | None) -> Torches:
    """Where the torches stand for a program; one alone where there is no profile."""
    if profile is None:
        return Torches()
    return profile.at_spacing(stated_spacing(program, None, profile.machine.torches)).machine.torches


def path_of_program(program: NcProgram, file: str | Path | None = None, profile: Profile | None = None) -> TimedPath:
    """Where the torch burns by a program, at its own feeds and for its own waits.

    A torch that leans burns where its jet is at half the depth of the profile's sheet.
    Further torches stand where the program or else the profile says. Rapids are as profiled, and so are pierces where
    the dialect leaves them to the machine. Raises InputError with file
    and line, for a program of more than a week: it cannot be simulated.
    """
    burns: list[TorchOn] = []
    shift = _torches_of(program, profile).shift
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
        way: tuple[Floats, Floats | None]
        if burn.tilted and profile is not None:
            way = jet_of(burn, profile).paced(profile.material.thickness_mm / 2)
        else:
            way = chords(burn.path, burn.paced, _CHORD_MM)
        points, slowness = way
        stands_s = burn.held_s + burn.pierce_s
        for lit in without_tabs(torch_on(name, points, burn.start_s, burn.end_s, stands_s, slowness), burn.unlit):
            burns += [lit, *(lit.by(torch, f"{name} by torch {torch}", shift(torch)) for torch in burn.torches)]
    path = in_order(burns, burns[-1].at_s[-1] if burns else 0.0)
    expect_short(path, file)
    return path


def path_of_made(
    source: Plan | str | Path, inputs: Inputs, tell: Tell, trusted: Trusted | None, along_contours: bool = False
) -> TimedPath:
    """Where the torch burns by a plan, or by a program.

    A contour with a bevel is burnt pass after pass where the jets are at half the depth, or `along_contours` once,
    as it is drawn, in the time of all its passes. Raises InputError for a program then: it does not tell that time.
    """
    has_bevels, block = next(bevelled(inputs.nest), None) is not None, inputs.profile.cuts.bevel.head == "block"
    if has_bevels and block and not along_contours:
        tell("of a block of torches the upright one is simulated alone, whichever of them burn")
    if not isinstance(source, Plan) and not is_plan_file(source):
        if has_bevels and along_contours:
            raise InputError("how contours with bevels move is simulated from the plan: give that", file=source)
        return path_of_program(read_program_of(source, inputs, tell, trusted), source, inputs.profile)
    plan, file = (source, None) if isinstance(source, Plan) else (read_plan(source), source)
    try:
        path = path_of_plan(plan, inputs.nest, inputs.profile, along_contours)
    except InputError as error:
        raise InputError(error.message, file=error.file or file, line=error.line, details=error.details) from None
    expect_plan_of(plan, inputs.nest)
    expect_short(path, file)
    for text in differences(plan, inputs):
        tell(text)
    return path
