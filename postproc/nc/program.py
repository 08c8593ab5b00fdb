"""A plan as the control's program: header, then for each cut rapid, torch on, pierce dwell, path, torch off."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain, tee
from pathlib import PurePath

from kerfwise.encoder.cut import Cut, Pierce
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.dialects import Dialect, expect_words, fitting_dialect, load_dialect, pierce_dwell_of, powers_of
from kerfwise.rules.profile.profile import Profile

from .blocks import comment, is_comment, number, numbered, plain, room_for, seconds_text
from .names import name_comments, program_names
from .pen import Pen
from .plan_paths import SHA_DIGITS, Toolpath, toolpaths
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
    paths, first = toolpaths(plan, nest, profile), plan.resumed_after + 1
    body = _body(paths, names, nest, profile, dialect, first, plan.pierces)
    return "\n".join([*numbered([*_header(plan, names, nest, profile, dialect), *body], dialect), ""])


def head_comments(plan: Plan, nest: Nest, profile: Profile) -> list[str]:
    """What a program of `plan` says at its top: what it was made of, what it assumes, what is excused in it."""
    dialect = fitting_dialect(profile)
    return [
        text for text in _header(plan, program_names(profile.as_cut(nest), dialect), nest, profile, dialect) if text
    ]


def cut_comment(order: int, name: str, cut: Cut, marks: bool, dialect: Dialect) -> str:
    """What stands before a cut: its number, name, zone and direction."""
    with_torch = f" TORCH {cut.torch}" if cut.torch > 1 else ""
    told = f"ZONE {cut.zone} {cut.direction.upper()}{with_torch}"
    return comment(dialect, f"{'MARK' if marks else 'CUT'} {order}", name, told)


def count_blocks(paths: Iterable[Toolpath], nest: Nest, profile: Profile, pierces: Sequence[Pierce] = ()) -> int:
    """How many blocks a program of these paths and pierces has, comments left out, without writing it."""
    dialect = load_dialect(profile.machine.dialect)
    body = _body(paths, {}, nest, profile, dialect, pierces=pierces)
    return sum(not is_comment(block, dialect) for block in body)


def _header(plan: Plan, names: Mapping[str, str], nest: Nest, profile: Profile, dialect: Dialect) -> Iterator[str]:
    totals, material, nest = plan.totals, profile.material, profile.as_cut(nest)
    yield comment(dialect, f"KERFWISE FOR {plain(dialect.title).upper()}")
    of_file = f"SHA256 {nest.sha256[:SHA_DIGITS]}" if nest.sha256 else "TOLD FROM AN OLDER PROGRAM"
    yield comment(dialect, "NEST", PurePath(nest.file).name, of_file)
    if nest.refit_arcs_mm is not None:
        yield comment(dialect, f"{ARCS_REFITTED} {number(nest.refit_arcs_mm, 9)} MM")
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


def _body(
    paths: Iterable[Toolpath],
    names: Mapping[str, str],
    nest: Nest,
    profile: Profile,
    dialect: Dialect,
    first: int = 1,
    pierces: Sequence[Pierce] = (),
) -> Iterator[str]:
    """All but the comments at the top, which make no blocks; `first` is the number of the first cut.

    `pierces` are made before the cuts that they say.
    """
    yield from (block.format(program=program_number(dialect)) for block in dialect.header)
    x, y = profile.frame_on(nest).corner
    pen = Pen(dialect, profile.machine.home, powers_of(dialect, profile))
    due: dict[int, list[tuple[int, Pierce]]] = {}
    for count, pierce in enumerate(pierces, 1):
        due.setdefault(pierce.before, []).append((count, pierce))
    pen.torches = profile.machine.torches.count
    order = first
    for made, after in _with_next(paths):
        for count, pierce in due.get(order, ()):
            at = round(pierce.at[0], 6) - x, round(pierce.at[1], 6) - y
            yield from _pierce(count, names.get(pierce.contour, ""), at, profile, pen)
        name, lit = names.get(made.planned.cut.contour, ""), after is not None and after.linked
        for more, planned in enumerate(made.together, order + 1):
            yield cut_comment(more, names.get(planned.cut.contour, ""), planned.cut, made.marks, dialect)
        yield from _cut(order, name, replace(made, path=made.path.moved(-x, -y)), profile, pen, stays_on=lit)
        order += 1 + len(made.together)
    yield comment(dialect, "HOME")
    yield from pen.leave(())  # the next program may be for one torch, and say nothing of others
    yield pen.rapid(profile.machine.home)
    yield from dialect.footer


def _with_next(paths: Iterable[Toolpath]) -> Iterator[tuple[Toolpath, Toolpath | None]]:
    """Each path with the one after it."""
    left, right = tee(paths)
    next(right, None)
    return zip(left, chain(right, [None]), strict=False)


def program_number(dialect: Dialect) -> str:
    """The number that the program is called by on the control, as its header spells it."""
    return "" if dialect.program is None else str(dialect.program.number).zfill(dialect.program.digits)


def _pierce(count: int, name: str, at: Point, profile: Profile, pen: Pen) -> Iterator[str]:
    """The blocks of one pierce of a pass: there, torch on, the dwell, off."""
    machine = profile.machine
    yield comment(pen.dialect, f"PIERCE {count}", name)
    yield from pen.select(False)
    yield pen.rapid(at)
    yield from pen.start(False, machine.pierce_time_s, machine.cut_feed_mm_s)
    yield from pen.stop(False)


def _cut(order: int, name: str, made: Toolpath, profile: Profile, pen: Pen, stays_on: bool) -> Iterator[str]:
    """The blocks of one cut; of one that is linked without those that light the torch, of one before it without off."""
    cut, machine, mark, dialect = made.planned.cut, profile.machine, made.marks, pen.dialect
    yield cut_comment(order, name, cut, mark, dialect)
    feed_mm_s = machine.mark_feed_mm_s if mark else machine.cut_feed_mm_s * made.feed_share
    if not made.linked:
        yield from pen.select(mark)
        lit = {planned.cut.torch for planned in made.together}
        yield from pen.leave(lit)
        yield pen.rapid(made.path.point_at(0.0))
        yield from pen.add(lit)
        if made.planned.dwell_s > 0:  # metal cools, the torch being off
            yield from pen.wait(made.planned.dwell_s)
        waits = pierce_dwell_of(profile, dialect) == "program"
        start_s = machine.edge_preheat_s if made.edge_start else 0.0 if made.pierced else machine.pierce_time_s
        yield from pen.start(mark, (machine.mark_time_s if mark else start_s) if waits else 0.0, feed_mm_s)
    slowed = made.feed_share < 1.0
    yield from dialect.height_off if slowed else ()
    law = None if mark else profile.corner_feed()
    yield from pen.path(made.path, feed_mm_s, law, made.unlit)
    yield from dialect.height_on if slowed else ()
    yield from () if stays_on else pen.stop(mark)
