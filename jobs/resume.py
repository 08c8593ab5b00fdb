"""What a stopped program has already cut: read from its plan, or from the program itself, as far as it has come."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from kerfwise.encoder.already_cut import NOTHING_CUT, AlreadyCut, rest_of
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import OFF_MM, read_plan
from kerfwise.postproc.check.cuts_from_program import rebuild
from kerfwise.postproc.check.reader.read_program import read_on_machine
from kerfwise.postproc.verdict.check_plan import cuts_elsewhere
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.profile import Profile

from .inputs import Inputs, Tell, damaged, expect_one_torch, is_plan_file, program_text, silent


def already_cut(
    inputs: Inputs,
    old: Plan | str | Path | None,
    upto: int | None,
    redo_last: bool = False,
    tell: Tell = silent,
) -> AlreadyCut:
    """What is cut already, by an old plan or program (or the file of one) as far as it has come.

    Raises InputError if one of the two is given without the other, and no lock calls a cut by its number in the old
    plan; if the file cannot be read or does not fit the nest, or nothing is left to cut.
    """
    if upto is None and not redo_last and (old is None or _names_cuts_only(inputs)):
        return NOTHING_CUT
    if old is None or upto is None:
        raise InputError(
            "--lock-from OLD and --upto N go together (in Python: resume_from and upto): which plan or program was "
            "stopped, and how many of its cuts are cut (--redo-last, in Python redo_last=True: the last broke off); "
            "OLD alone is for locks that call a cut by its number there, such as '#7 first'"
        )
    expect_one_torch(inputs.profile, "a program that goes on after a stop")
    file = "" if isinstance(old, Plan) else str(old)
    if isinstance(old, Plan) or is_plan_file(old):
        plan = old if isinstance(old, Plan) else read_plan(old)
        expect_one_torch(inputs.profile, "a program that goes on after a stop", plan, file)
        if plan.nest.get("sha256") != inputs.nest.sha256:
            tell(f"the nest is not the one {file or 'the old plan'} was made with (its sha256 differs)")
        for text in damaged(plan, inputs):
            tell(text)
        already = stopped_plan(plan, inputs.nest, upto, redo_last, file)
    else:
        already = stopped_program(program_text(old), inputs.nest, inputs.profile, upto, redo_last, file)
    if not rest_of(inputs.nest, already.contours).contours:
        raise InputError(f"{_upto(upto)}: every contour of the nest is cut, nothing is left; no program is written")
    return already


def _names_cuts_only(inputs: Inputs) -> bool:
    """Whether locks call cuts by numbers, so that an old plan may be given for these alone."""
    made_with = inputs.profile.for_one_nest
    return made_with is not None and bool(made_with.numbered)


def lock_broken_cut_first(profile: Profile, already: AlreadyCut) -> Profile:
    """The profile with a lock on the cut that broke off: it comes first of what is left."""
    cut = already.broken_off
    if cut is None:
        return profile
    place = len(already.cuts) + 1
    lock = Lock(contour=cut.contour, position=place, reason=f"it broke off as cut {place} and is cut again")
    return replace(profile, locks=(*profile.locks, lock))


def stopped_plan(plan: Plan, nest: Nest, upto: int, redo_last: bool = False, file: str = "") -> AlreadyCut:
    """The first `upto` cuts of a plan; those that it found already made count among them.

    With `redo_last` the last of them has broken off. Raises InputError if the plan has fewer cuts, begins later, does
    not fit the nest, or has a pierce pass.
    """
    if plan.pierces:
        raise _with_a_pass("plan", file)
    cuts = [planned.cut for planned in (*plan.already_cut, *plan.cuts)]
    _expect(upto, plan.resumed_after, len(cuts), "plan", file)
    for k, cut in enumerate(cuts[:upto], 1):
        if cut.contour not in nest.index:
            raise InputError(f"the plan cuts {cut.contour} as cut {k}, which {_named(nest)} does not have", file=file)
        off_mm = nest.contour(cut.contour).curve.project(cut.entry)[1]
        if off_mm > OFF_MM:
            raise InputError(
                f"the plan does not fit {_named(nest)}: cut {k} enters {cut.contour} {off_mm:.1f} mm off it; give the "
                "nest that the plan was made from",
                file=file,
            )
    return _stopped(cuts, [(k, planned.cut) for k, planned in plan.begun], upto, redo_last, "plan", file)


def stopped_program(
    text: str, nest: Nest, profile: Profile, upto: int, redo_last: bool = False, file: str = ""
) -> AlreadyCut:
    """The first `upto` cuts of an NC program, a mark counting as one; a program that was resumed itself counts on.

    Which contour each of them is of is seen from the torch's path alone. Raises InputError if the program cannot be
    read, has fewer cuts, begins later, does not fit the nest, or has a pierce pass.
    """
    program = read_on_machine(text, nest, profile, file)
    if any(burn.pierces_only for burn in program.burns):
        raise _with_a_pass("program", file)
    kerf_mm = profile.material.kerf_mm
    cuts_elsewhere(program, nest, kerf_mm, file)
    built = rebuild(nest, program, kerf_mm, profile.home_on(nest))
    count = built.cuts.made
    _expect(upto, count, count + max(len(program.burns), len(built.cuts.new)), "program", file)
    if texts := [v.text for v in built.violations if not v.cuts and not v.text.startswith("line ")]:
        raise InputError(f"the program does not say clearly what was cut before it: {texts[0]}", file=file)
    a_run_a_burn = len(program.burns) == len(built.runs)
    for k, run in enumerate(built.runs, count + 1):
        if k <= upto and run.contour is None:
            message = f"cut {k} runs along no contour of {_named(nest)}: is it the nest of this program?"
            raise InputError(message, file=file, line=program.burns[k - count - 1].line if a_run_a_burn else None)
    return _stopped(built.cuts, _named_ways(built.cuts.begun), upto, redo_last, "program", file)


def _with_a_pass(what: str, file: str) -> InputError:
    text = f"the {what} has a pierce pass: holes of contours that are not cut yet are in the sheet"
    return InputError(
        f"{text}, and no work can go on from there; cut the rest by hand, or from the old program", file=file
    )


def _named_ways(begun: Sequence[tuple[int, Cut]]) -> list[tuple[int, Cut]]:
    """The stretches with names of the ways that they belong to: a program tells its burns apart, and names none."""
    found, count = list[tuple[int, Cut]](), 0
    for k, cut in begun:
        count += not cut.linked
        found.append((k, cut if cut.way else replace(cut, way=f"way{count}")))
    return found


def _upto(count: int) -> str:
    return f"--upto {count} (in Python: upto={count})"


def _expect(upto: int, cuts_made: int, count: int, what: str, file: str) -> None:
    if upto > count:
        raise InputError(f"{_upto(upto)}: the {what} has {count} cuts only", file=file)
    if upto < cuts_made:
        raise InputError(
            f"{_upto(upto)}: the {what} goes on after cut {cuts_made} itself, so that at least {cuts_made} are cut",
            file=file,
        )


def _stopped(
    cuts: Sequence[Cut], begun: Sequence[tuple[int, Cut]], upto: int, redo_last: bool, what: str, file: str
) -> AlreadyCut:
    first: dict[str, int] = {}
    for k, cut in enumerate(cuts[:upto], 1):
        if cut.contour in first:
            message = f"the {what} cuts {cut.contour} twice, as cut {first[cut.contour]} and as cut {k}"
            raise InputError(message, file=file)
        first[cut.contour] = k
    before = tuple((k, cut) for k, cut in begun if k <= upto)
    if redo_last and any(cut.contour == cuts[upto - 1].contour for _, cut in before):
        message = f"cut {upto} finishes {cuts[upto - 1].contour}, which was begun before, and cannot be made again"
        raise InputError(f"{message}: cut it by hand", file=file)
    if redo_last:
        return AlreadyCut(tuple(cuts[: upto - 1]), cuts[upto - 1], before)
    return AlreadyCut(tuple(cuts[:upto]), None, before)


def _named(nest: Nest) -> str:
    return nest.file or "the nest"
