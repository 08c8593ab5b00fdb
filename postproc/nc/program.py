"""A plan as the control's program: header, then for each cut rapid, torch on, pierce dwell, path, torch off."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import PurePath

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.slits import features_cut_across
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.dialects import Dialect, expect_words, fitting_dialect, pierce_dwell_of, powers_of
from kerfwise.rules.profile.profile import Profile

from .blocks import comment, number, numbered, plain, room_for, seconds_text
from .body import body_of_plan
from .names import name_comments, program_names
from .plan_paths import SHA_DIGITS
from .reading_comments import reading_comments
from .resume_comments import out_comments, resume_comment
from .setting_comments import setting_comments

ARCS_REFITTED = "ARCS REFITTED WITHIN"
"""What a program of a nest says whose flattened outlines were made arcs again; a length in mm follows."""


def write_program(plan: Plan, nest: Nest, profile: Profile, dialect: Dialect | None = None) -> str:
    """The program of `plan` in the dialect of the profile's machine, or in one that has no file.

    Kerf compensation is in the path (the program keeps G40); pierce points, order and directions are the plan's. The
    same plan, nest and profile give the same bytes, and so does the plan once written to a file and read back.

    Raises
    ------
    InputError
        If the plan was made from another nest, or the dialect is unknown or cannot spell the program.
    """
    dialect = dialect or fitting_dialect(profile)
    expect_words(nest, profile, dialect, bool(plan.already))
    profile = profile.at_origin(plan.origin).at_spacing(plan.sequence().spacing_mm(profile.machine.torches.axis))
    names = program_names(profile.as_cut(nest), dialect)
    body = body_of_plan(plan, names, nest, profile, dialect)
    return "\n".join([*numbered([*_header(plan, names, nest, profile, dialect), *body], dialect), ""])


def head_comments(plan: Plan, nest: Nest, profile: Profile) -> list[str]:
    """What a program of `plan` says at its top: what it was made of, what it assumes, what is excused in it."""
    dialect = fitting_dialect(profile)
    return [
        text for text in _header(plan, program_names(profile.as_cut(nest), dialect), nest, profile, dialect) if text
    ]


def _header(plan: Plan, names: Mapping[str, str], nest: Nest, profile: Profile, dialect: Dialect) -> Iterator[str]:
    totals, material, nest = plan.totals, profile.material, profile.as_cut(nest)
    yield comment(dialect, f"KERFWISE FOR {plain(dialect.title).upper()}")
    of_file = f"SHA256 {nest.sha256[:SHA_DIGITS]}" if nest.sha256 else "TOLD FROM AN OLDER PROGRAM"
    yield comment(dialect, "NEST", PurePath(nest.file).name, of_file)
    if nest.refit_arcs_mm is not None:
        yield comment(dialect, f"{ARCS_REFITTED} {number(nest.refit_arcs_mm, 9)} MM")
    yield from reading_comments(nest, dialect)
    yield comment(dialect, "PROFILE", profile.name, f"SHA256 {profile.sha256[:SHA_DIGITS]}")
    if profile.for_one_nest is not None and (job := profile.for_one_nest).file:
        yield comment(dialect, "JOB", job.file, f"SHA256 {job.sha256[:SHA_DIGITS]}")
    for name, file in profile.rule_files().items():
        what = "RULE FILE IN PLACE OF" if file.in_place_of_shipped else "RULE FILE"
        yield comment(dialect, what, name, f"SHA256 {file.sha256[:SHA_DIGITS]}")
    yield from resume_comment(plan, dialect)
    thickness, kerf = number(material.thickness_mm, 3), number(material.kerf_mm, 3)
    yield comment(dialect, "MATERIAL", material.name, f"{thickness} MM, KERF {kerf} MM")
    yield from setting_comments(profile, dialect)
    yield _origin(nest, profile, dialect)
    yield comment(dialect, f"CONTOURS {len(plan.cuts)}, PIERCES {totals.pierces}")
    yield comment(dialect, f"CUT {number(totals.cut_mm, 1)} MM, IDLE {number(totals.idle_mm, 1)} MM")
    yield comment(dialect, f"ESTIMATED TIME {seconds_text(totals.time_s)}")
    if plan.time is not None:
        yield comment(dialect, "TIME MODEL", plan.time.model.upper())
    if (torches := profile.machine.torches).several:
        spacing = number(torches.spacing_mm, 3)
        yield comment(dialect, f"TORCHES {torches.count}, {spacing} MM APART ALONG {torches.axis.upper()}")
    if plan.cuts:
        yield from _assumed(plan, profile, dialect)
    if plan.pierces:
        passes = len({pierce.before for pierce in plan.pierces})
        yield comment(dialect, f"PIERCED IN PASSES OF THEIR OWN {len(plan.pierces)}, PASSES {passes}")
    if plan.waits:
        yield comment(dialect, f"WAITS FOR METAL TO COOL {len(plan.waits)}, {seconds_text(plan.wait_s)}")
    if nest.spotted:
        yield comment(dialect, f"SMALL HOLES MARKED AT THEIR MIDDLE {len(nest.spotted)}")
    slits = sum(planned.kind == "slit" for planned in (*plan.already_cut, *plan.cuts))
    if slits:
        yield comment(dialect, f"NARROW SLOTS OPENED BY ONE PASS {slits}")
    if across := sum(map(len, features_cut_across(nest, profile.material.kerf_mm).values())):
        yield comment(dialect, f"SLOTS AND NOTCHES NARROWER THAN THE KERF, CUT ACROSS {across}")
    for k, left in enumerate(plan.left_out, 1):
        yield comment(dialect, f"LEFT OUT {k}", names.get(left.contour, left.contour))
    if nest.losses:
        loss = f"{len(nest.losses)} LOSE {number(nest.losses[0].loss_mm, 3)} MM"
        yield comment(dialect, f"PARTS TOUCH AND ARE CUT APART BY ONE CUT, {loss} THERE")
    yield from name_comments(names, dialect)
    yield comment(dialect, f"START SIDE {plan.start_side.upper()}")
    for planned in plan.cuts:
        for rule in planned.cut.excused:
            yield comment(dialect, f"EXCUSED {plain(rule)}", names[planned.cut.contour])
    yield from _relaxed(plan, names, dialect)
    yield from out_comments(plan, names, dialect)


def _origin(nest: Nest, profile: Profile, dialect: Dialect) -> str:
    """Where the machine's zero lies on the drawing."""
    if profile.machine.origin == "drawing":
        return comment(dialect, "ORIGIN DRAWING")
    x, y = (number(v, 4) for v in profile.frame_on(nest).corner)
    return comment(dialect, f"ORIGIN SHEET CORNER, AT X{x} Y{y} OF THE DRAWING")


def _assumed(plan: Plan, profile: Profile, dialect: Dialect) -> Iterator[str]:
    """What the program takes for granted of the machine, and who waits at a pierce."""
    machine = profile.machine
    waits = pierce_dwell_of(profile, dialect)
    yield comment(dialect, f"PIERCE DELAY {number(machine.pierce_time_s, 3)} S, HELD BY THE {waits.upper()}")
    of = [machine.process, *(["marks"] if any(planned.kind == "mark" for planned in plan.cuts) else [])]
    of += ["torches"] if machine.torches.several else []
    for told in (text for key in of for text in dialect.assumes.get(key, ())):
        yield comment(dialect, "ASSUMES", told.format(**powers_of(dialect, profile)))


def _relaxed(plan: Plan, names: Mapping[str, str], dialect: Dialect) -> Iterator[str]:
    """What is relaxed, a number each; contours that have no room go on in another comment of that number."""
    for k, dropped in enumerate((d for d in plan.dropped if d.relaxed), 1):
        head = f"RELAXED {k} {plain(dropped.rule)}"
        room = room_for(dialect, head)
        line = ""
        for name in (plain(names.get(contour, contour)).replace(" ", "_") for contour in dropped.contours):
            if line and len(line) + 1 + len(name) > room:
                yield comment(dialect, head, line)
                line = ""
            line = f"{line} {name}".lstrip()
        yield comment(dialect, head, line)
