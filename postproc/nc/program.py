"""A plan as the control's program: header, then for each cut rapid, torch on, pierce dwell, path, torch off."""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, takewhile, tee
from pathlib import PurePath

from kerfwise.encoder.cut import Cut, Pierce
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.slits import features_cut_across
from kerfwise.encoder.torch_path import CornerFeed
from kerfwise.models.plan.plan import Plan, PlannedCut
from kerfwise.postproc.dialects import (
    Dialect,
    expect_words,
    fitting_dialect,
    load_dialect,
    pierce_dwell_of,
    plant_words,
    powers_of,
)
from kerfwise.rules.profile.technique import Technique
from kerfwise.rules.rule import name_in_programs

from .gcode import (
    GcodeWriter,
    comment,
    is_comment,
    number,
    number_blocks,
    plain,
    room_for,
    seconds_text,
    with_subprograms,
)
from .head_comments import name_comments, program_names, reading_comments, setting_comments
from .kerf_by_control import keeps_left
from .tilted import BLOCK_TORCHES, UPRIGHT, bevel_passes, kerf_assumptions
from .toolpaths import SHA_DIGITS, Toolpath, expect_same_nest, toolpaths

ARCS_REFITTED = "ARCS REFITTED WITHIN"
"""What a program of a nest says whose flattened outlines were made arcs again; a length in mm follows."""


def write_program(plan: Plan, nest: Nest, profile: Technique, dialect: Dialect | None = None) -> str:
    """The program of `plan` in the dialect of the profile's machine, or in one that has no file.

    Kerf compensation is in the path (the program keeps G40), unless the dialect has the control add it; pierce points,
    order and directions are the plan's. The same plan, nest and profile give the same bytes, and so does the plan once
    written to a file and read back. Raises InputError if the plan was made from another nest, or the dialect is unknown
    or cannot spell the program.
    """
    dialect = dialect or fitting_dialect(profile)
    expect_words(nest, profile, dialect, bool(plan.already))
    profile = profile.at_origin(plan.origin).at_spacing(plan.sequence().spacing_mm(profile.machine.torches.axis))
    names = program_names(profile.as_cut(nest), dialect)
    body = body_of_plan(plan, names, nest, profile, dialect)
    first = opening(dialect)  # before all comments
    blocks = [*body[:first], *_header(plan, names, nest, profile, dialect), *with_subprograms(body[first:], dialect)]
    return NEWLINES[dialect.newline].join([*number_blocks(blocks, dialect), ""])


def head_comments(plan: Plan, nest: Nest, profile: Technique) -> list[str]:
    """What a program of `plan` says at its top: what it was made of, what it assumes, what is excused in it."""
    dialect = fitting_dialect(profile)
    return [
        text for text in _header(plan, program_names(profile.as_cut(nest), dialect), nest, profile, dialect) if text
    ]


def _header(plan: Plan, names: Mapping[str, str], nest: Nest, profile: Technique, dialect: Dialect) -> Iterator[str]:
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
    yield from _order_comments(nest, profile, dialect)
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
    if plan.state is not None:
        yield comment(dialect, f"STATE {plan.state.short().upper()}")
    for planned in plan.cuts:
        for rule in planned.cut.excused:
            yield comment(dialect, f"EXCUSED {plain(rule)}", names[planned.cut.contour])
    yield from _relaxed(plan, names, dialect)
    yield from out_comments(plan, names, dialect)


def _order_comments(nest: Nest, profile: Technique, dialect: Dialect) -> Iterator[str]:
    """What a nest of a list, and a job file, say of the sheet: size, orders, first due date, day, and what parts."""
    orders = {} if profile.for_one_nest is None else profile.for_one_nest.said
    parts = (nest.drawn or nest).parts
    listed = any(key in part.attributes for part in parts for key in ("of", "order", "due"))
    if not listed and not orders:
        return
    number_said = program_number(dialect, profile)
    if any("{program}" in block for block in dialect.header) and "number" in orders:
        yield comment(dialect, "PROGRAM", number_said)
    if "date" in orders:
        yield comment(dialect, "DATE", orders["date"])
    x0, y0, x1, y1 = nest.sheet.bounds
    yield comment(dialect, f"SHEET {number(x1 - x0, 1)} X {number(y1 - y0, 1)} MM, PARTS {len(parts)}")
    for key, word in (("order", "ORDER"), ("due", "DUE")):
        of_parts = sorted({str(part.attributes[key]) for part in parts if part.attributes.get(key)})
        values = of_parts or [orders[key]] if key in orders else of_parts
        for value in values[:1] if key == "due" else values[:_MOST_ORDERS]:
            yield comment(dialect, word, value)
    if listed:
        counts = Counter(str(part.attributes.get("of") or part.id) for part in parts)
        for name, count in list(counts.items())[:_MOST_ORDERS]:
            yield comment(dialect, f"PARTS {count} OF", name)


_MOST_ORDERS = 30
"""So many orders and kinds of parts are named at the top of a program."""


def _origin(nest: Nest, profile: Technique, dialect: Dialect) -> str:
    """Where the machine's zero lies on the drawing."""
    if profile.machine.origin == "drawing":
        return comment(dialect, "ORIGIN DRAWING")
    x, y = (number(v, 4) for v in profile.frame_on(nest).corner)
    return comment(dialect, f"ORIGIN SHEET CORNER, AT X{x} Y{y} OF THE DRAWING")


def _assumed(plan: Plan, profile: Technique, dialect: Dialect) -> Iterator[str]:
    """What the program takes for granted of the machine, and who waits at a pierce."""
    machine = profile.machine
    waits = pierce_dwell_of(profile, dialect)
    yield comment(dialect, f"PIERCE DELAY {number(machine.pierce_time_s, 3)} S, HELD BY THE {waits.upper()}")
    if dialect.kerf is not None:
        yield comment(dialect, "ASSUMES", f"THE CONTROL ADDS A KERF OF {number(profile.material.kerf_mm, 3)} MM")
    of = [machine.process, *(["marks"] if any(planned.kind == "mark" for planned in plan.cuts) else [])]
    of += ["torches"] if machine.torches.several else []
    of += ["block" if profile.cuts.bevel.head == "block" else "bevels"] if any(c.passes for c in plan.cuts) else []
    for assumption in (text for key in of for text in dialect.assumes.get(key, ())):
        yield comment(dialect, "ASSUMES", assumption.format(**powers_of(dialect, profile)))
    yield from (comment(dialect, "ASSUMES", text) for text in kerf_assumptions(plan, profile))


def _relaxed(plan: Plan, names: Mapping[str, str], dialect: Dialect) -> Iterator[str]:
    """What is relaxed, a number each; contours that have no room go on in another comment of that number."""
    for k, dropped in enumerate((d for d in plan.dropped if d.relaxed), 1):
        head = f"RELAXED {k} {plain(name_in_programs(dropped.rule)).replace(' ', '_')}"
        room = room_for(dialect, head)
        line = ""
        for name in (plain(names.get(contour, contour)).replace(" ", "_") for contour in dropped.contours):
            if line and len(line) + 1 + len(name) > room:
                yield comment(dialect, head, line)
                line = ""
            line = f"{line} {name}".lstrip()
        yield comment(dialect, head, line)


# The blocks that make a plan's cuts, without the comments at the top of its program; its times count the same.


@dataclass(frozen=True, slots=True)
class _Spelt:
    """What the blocks of a plan's cuts hang on: times and verdicts do not change them."""

    cuts: tuple[tuple[object, ...], ...]
    pierces: tuple[tuple[object, ...], ...]
    first: int
    program: str
    names: Mapping[str, str] = field(hash=False)
    profile: Technique = field(hash=False)
    dialect: Dialect = field(hash=False)


def body_of_plan(
    plan: Plan,
    names: Mapping[str, str],
    nest: Nest,
    profile: Technique,
    dialect: Dialect,
    paths: Sequence[Toolpath] | None = None,
) -> tuple[str, ...]:
    """All blocks but the comments at the top; the last ones asked for are kept with the nest.

    `names` are those of contours, the profile has the plan's origin, and `paths` are the plan's, where they are known.
    Raises InputError if the plan was made from another nest.
    """
    expect_same_nest(plan, profile.as_cut(nest))
    cuts = tuple((*_geometry(planned.cut), planned.dwell_s) for planned in plan.burns)
    pierces, first = tuple((hole.contour, hole.at, hole.before) for hole in plan.pierces), plan.resumed_after + 1
    spelt = _Spelt(cuts, pierces, first, program_number(dialect, profile), names, profile, dialect)
    known = nest.kept.setdefault(body_of_plan, OrderedDict())
    body: tuple[str, ...] | None = known.get(spelt)
    if body is None:
        paths = toolpaths(plan, nest, profile) if paths is None else paths
        body = tuple(_body(paths, names, nest, profile, dialect, first, plan.pierces))
        known.clear()
        known[spelt] = body
    return body


def blocks_of_plan(plan: Plan, nest: Nest, profile: Technique, paths: Sequence[Toolpath]) -> int:
    """How many blocks the program of a plan has, comments left out; see `body_of_plan`."""
    dialect = load_dialect(profile.machine.dialect)
    names = program_names(profile.as_cut(nest), dialect)
    return sum(not is_comment(block, dialect) for block in body_of_plan(plan, names, nest, profile, dialect, paths))


def _geometry(cut: Cut) -> tuple[object, ...]:
    """All of a cut but its times, its entry, and what it is excused from. Leads are told apart as objects."""
    ways = cut.pierce, cut.lead_in, cut.lead_out, cut.span, cut.tabs
    return cut.contour, cut.direction, *ways, cut.zone, cut.linked, cut.torch, cut.together, cut.way


def cut_comment(order: int, name: str, cut: Cut, marks: bool, dialect: Dialect) -> str:
    """What stands before a cut: its number, name, zone and direction; before a stretch, which way it belongs to."""
    if cut.way:
        return comment(dialect, f"STRETCH {plain(cut.way)}", name, f"ZONE {cut.zone} {cut.direction.upper()}")
    with_torch = f" TORCH {cut.torch}" if cut.torch > 1 else ""
    text = f"ZONE {cut.zone} {cut.direction.upper()}{with_torch}"
    return comment(dialect, f"{'MARK' if marks else 'CUT'} {order}", name, text)


def count_blocks(paths: Iterable[Toolpath], nest: Nest, profile: Technique, pierces: Sequence[Pierce] = ()) -> int:
    """How many blocks a program of these paths and pierces has, comments left out, without writing it."""
    dialect = load_dialect(profile.machine.dialect)
    body = _body(paths, {}, nest, profile, dialect, pierces=pierces)
    return sum(not is_comment(block, dialect) for block in body)


def _body(
    paths: Iterable[Toolpath],
    names: Mapping[str, str],
    nest: Nest,
    profile: Technique,
    dialect: Dialect,
    first: int = 1,
    pierces: Sequence[Pierce] = (),
) -> Iterator[str]:
    """All but the comments at the top, which make no blocks; `first` is the number of the first cut.

    `pierces` are made before the cuts that they say.
    """
    plant = plant_words(dialect, profile)
    yield from header_blocks(dialect, plant, program_number(dialect, profile))
    x, y = profile.frame_on(nest).corner
    pen = GcodeWriter(dialect, profile.machine.home, powers_of(dialect, profile), plant)
    due: dict[int, list[tuple[int, Pierce]]] = {}
    for count, pierce in enumerate(pierces, 1):
        due.setdefault(pierce.before, []).append((count, pierce))
    bevel, several = profile.cuts.bevel, profile.machine.torches.count
    pen.torches, pen.kerf_mm = max(BLOCK_TORCHES) if bevel.head == "block" else several, profile.material.kerf_mm
    order = first
    if dialect.subprogram is not None:
        paths = list(paths)
        pen.shared = _shared(paths, profile, dialect, pen)
    for toolpath, after in _with_next(paths):
        for count, pierce in due.pop(order, ()):
            at = round(pierce.at[0], 6) - x, round(pierce.at[1], 6) - y
            yield from _pierce(count, names.get(pierce.contour, ""), at, profile, pen)
        name, lit = names.get(toolpath.planned.cut.contour, ""), after is not None and after.linked
        for more, planned in enumerate(toolpath.together, order + 1):
            yield cut_comment(more, names.get(planned.cut.contour, ""), planned.cut, toolpath.marks, dialect)
        toolpath = toolpath if x == y == 0 else replace(toolpath, path=toolpath.path.moved(-x, -y))
        if toolpath.passes:
            yield from bevel_passes(order, name, toolpath, (x, y), profile, pen)
        else:
            yield from _cut(order, name, toolpath, profile, pen, stays_on=lit)
        order += (not toolpath.planned.cut.way) + len(toolpath.together)
    yield comment(dialect, "HOME")
    yield from pen.leave(())  # the next program may be for one torch, and say nothing of others
    if pen.upright and not pen.turned:
        pen.upright = f"{bevel.turn}0" if bevel.head == "block" else f"{bevel.tilt}0 {bevel.turn}0"
    yield pen.rapid(profile.machine.home)
    yield from dialect.footer


def _with_next(paths: Iterable[Toolpath]) -> Iterator[tuple[Toolpath, Toolpath | None]]:
    """Each path with the one after it."""
    left, right = tee(paths)
    next(right, None)
    return zip(left, chain(right, [None]), strict=False)


NEWLINES = {"lf": "\n", "crlf": "\r\n"}


def header_blocks(dialect: Dialect, plant: Mapping[str, str], program: str | None = None) -> Iterator[str]:
    """The blocks before the first cut; one that stands for words of the material's process may be several.

    `program` is the number that the program is called by, where that is not the dialect's own.
    """
    called = program_number(dialect) if program is None else program
    for block in dialect.header:
        text = block.format(program=called, **plant)
        yield from (one.strip() for one in text.split(";")) if "{process}" in block else (text,)


def opening(dialect: Dialect) -> int:
    """How many blocks of the header come before everything: those that frame a program, and name it."""
    named = takewhile(lambda block: block.startswith(("%", "O", ":")), dialect.header)
    return sum(1 for _ in named)


def program_number(dialect: Dialect, profile: Technique | None = None) -> str:
    """The number that the program is called by on the control, as its header spells it: the job file's, or its own."""
    if dialect.program is None:
        return ""
    said = {} if profile is None or profile.for_one_nest is None else profile.for_one_nest.said
    return str(int(said.get("number", dialect.program.number))).zfill(dialect.program.digits)


def _pierce(count: int, name: str, at: Point, profile: Technique, pen: GcodeWriter) -> Iterator[str]:
    """The blocks of one pierce of a pass: there, torch on, the dwell, off."""
    machine = profile.machine
    yield comment(pen.dialect, f"PIERCE {count}", name)
    yield from pen.select(False)
    yield pen.rapid(at)
    yield from pen.start(False, machine.pierce_time_s, machine.cut_feed_mm_s)
    yield from pen.stop(False)


def _cut(
    order: int, name: str, toolpath: Toolpath, profile: Technique, pen: GcodeWriter, stays_on: bool
) -> Iterator[str]:
    """The blocks of one cut; of one that is linked without those that light the torch, of one before it without off."""
    cut, machine, mark, dialect = toolpath.planned.cut, profile.machine, toolpath.marks, pen.dialect
    yield cut_comment(order, name, cut, mark, dialect)
    feed_mm_s, law = _pace(toolpath, profile)
    around = dialect.around_kind(_kind(toolpath))
    left = None if dialect.kerf is None else keeps_left(toolpath.planned.kind, cut.direction)
    if not toolpath.linked:
        yield from pen.select(mark)
        lit = {planned.cut.torch for planned in toolpath.together}
        lit = {UPRIGHT} if profile.cuts.bevel.head == "block" and not mark else lit
        yield from pen.leave(lit)
        yield from [pen.rapid(toolpath.path.point_at(0.0))] if left is None else pen.beside(toolpath.path, left)
        yield from pen.add(lit)
        if toolpath.planned.dwell_s > 0:  # metal cools, the torch being off
            yield from pen.wait(toolpath.planned.dwell_s)
        waits = pierce_dwell_of(profile, dialect) == "program"
        start_s = machine.unpierced_s if toolpath.edge_start else machine.pierce_time_s
        start_s = machine.at_hole_s if toolpath.pierced and not toolpath.edge_start else start_s
        yield from pen.others(block.format(**pen.powers, **pen.plant) for block in around.before)
        yield from pen.start(mark, (machine.mark_time_s if mark else start_s) if waits else 0.0, feed_mm_s)
    slowed = toolpath.feed_share < 1.0
    yield from dialect.height_off if slowed else ()
    if dialect.subprogram is None:
        yield from pen.path(toolpath.path, feed_mm_s, law, toolpath.unlit, left)
    else:
        yield from pen.called_path(toolpath.path, feed_mm_s, law, toolpath.unlit, pen.shared)
    yield from dialect.height_on if slowed else ()
    yield from () if stays_on else pen.stop(mark)
    if left is not None and dialect.kerf is not None:
        yield from pen.others([dialect.kerf.off])
    if not stays_on:
        yield from pen.others(block.format(**pen.powers, **pen.plant) for block in around.after)


def _shared(
    paths: Sequence[Toolpath], profile: Technique, dialect: Dialect, like: GcodeWriter
) -> frozenset[tuple[str, ...]]:
    """The blocks of paths, each from where it begins, that come more than once."""
    often: Counter[tuple[str, ...]] = Counter()
    for toolpath in paths:
        pen = GcodeWriter(dialect, (0.0, 0.0), like.powers, like.plant)
        feed_mm_s, law = _pace(toolpath, profile)
        often[tuple(pen.called_path(toolpath.path, feed_mm_s, law, toolpath.unlit))] += 1
    return frozenset(path for path, count in often.items() if count > 1)


def _pace(toolpath: Toolpath, profile: Technique) -> tuple[float, CornerFeed | None]:
    """The feed of a cut, mm/s, and how it slows at corners."""
    machine = profile.machine
    if toolpath.marks:
        return machine.mark_feed_mm_s, None
    return machine.cut_feed_mm_s * toolpath.feed_share, profile.corner_feed()


def _kind(toolpath: Toolpath) -> str:
    """What a cut is, for the blocks that a dialect has around it."""
    kind = "mark" if toolpath.marks else toolpath.planned.kind
    return "small_hole" if kind == "hole" and toolpath.feed_share < 1.0 else kind


# What a program that goes on after a stop says of what is already cut, in comments that a control passes over.
#
# (RESUME AFTER CUT 2) (OUT 1 P1.hole1 ZONE 1 CCW PIERCE 30 42) (OUT 1 LEAD IN 30 42 0 30 36.75 0) (OUT 1 LEAD OUT 30
# 36.75 0 31 36.75 0) (OUT 2 P1.outer ZONE 1 CW PIERCE 8 3.25) (OUT 2 TAB 40 12 0.5)
#
# Each vertex of a lead is x, y and the bulge of the segment that begins there. A lead that has no room on one line
# goes on in the next comment with the same words. A cut that was linked with the one before has LINK IN instead of
# LEAD IN. Of a tab the middle and the width are told. A cut that broke off, and is made again, is told as BROKEN
# instead of OUT.

DECIMALS = 6


def resume_comment(plan: Plan, dialect: Dialect) -> Iterator[str]:
    """That the program goes on after a stop, and after which cut; nothing for a plan that begins with cut 1."""
    if plan.already:
        again = "" if plan.broken_off is None else f", CUT {plan.resumed_after + 1} AGAIN"
        yield comment(dialect, f"RESUME AFTER CUT {plan.resumed_after}{again}")


def out_comments(plan: Plan, names: Mapping[str, str], dialect: Dialect) -> Iterator[str]:
    """What is already cut, cut by cut, and what broke off."""
    for k, planned in enumerate(plan.already_cut, 1):
        yield from _cut_out(f"OUT {k}", planned, names, dialect)
    for j, (k, planned) in enumerate((row for row in plan.begun if row[0] <= plan.resumed_after), 1):
        yield from _begun_out(j, k, planned, names, dialect)
    if plan.broken_off is not None:
        yield from _cut_out(f"BROKEN {plan.resumed_after + 1}", plan.broken_off, names, dialect)


def _cut_out(head: str, planned: PlannedCut, names: Mapping[str, str], dialect: Dialect) -> Iterator[str]:
    cut = planned.cut
    place = " ".join(number(v, DECIMALS) for v in cut.pierce)
    told = f"ZONE {cut.zone} {cut.direction.upper()} PIERCE {place}"
    yield comment(dialect, head, names.get(cut.contour, cut.contour), told)
    yield from _lead(f"{head} {'LINK' if cut.linked else 'LEAD'} IN", cut.lead_in, dialect)
    yield from _lead(f"{head} LEAD OUT", cut.lead_out, dialect)
    for tab in cut.tabs:
        yield comment(dialect, f"{head} TAB", " ".join(number(v, DECIMALS) for v in (*tab.at, tab.width_mm)))


def _begun_out(
    count: int, before: int, planned: PlannedCut, names: Mapping[str, str], dialect: Dialect
) -> Iterator[str]:
    """A stretch that leaves its contour unfinished: before which cut, from where to where, and its lead or link."""
    cut, span = planned.cut, planned.cut.span
    if span is None:
        return
    ends = " TO ".join(" ".join(number(v, DECIMALS) for v in at) for at in (span.begin, span.end))
    told = f"ZONE {cut.zone} {cut.direction.upper()} FROM {ends}"
    yield comment(dialect, f"BEGUN {count} BEFORE {before}", names.get(cut.contour, cut.contour), told)
    yield from _lead(f"BEGUN {count} {'LINK' if cut.linked else 'LEAD'} IN", cut.lead_in, dialect)


def _lead(head: str, lead: Curve | None, dialect: Dialect) -> Iterator[str]:
    """Comments with the vertices of a lead, as many whole ones at a time as there is room for."""
    room, line = room_for(dialect, head), list[str]()
    for row in () if lead is None else lead.as_rows():
        vertex = [number(v, DECIMALS) for v in (*row, 0.0)[:3]]
        if line and len(" ".join([*line, *vertex])) > room:
            yield comment(dialect, head, " ".join(line))
            line = []
        line += vertex
    if line:
        yield comment(dialect, head, " ".join(line))
