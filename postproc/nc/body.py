"""The blocks that make a plan's cuts, without the comments at the top of its program; its times count the same."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, tee

from kerfwise.encoder.cut import Cut, Pierce
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.dialects import Dialect, load_dialect, pierce_dwell_of, powers_of
from kerfwise.rules.profile.profile import Profile

from .blocks import comment, is_comment
from .names import program_names
from .pen import Pen
from .plan_paths import Toolpath, expect_same_nest, toolpaths


@dataclass(frozen=True, slots=True)
class _Spelt:
    """What the blocks of a plan's cuts hang on: times and verdicts do not change them."""

    cuts: tuple[tuple[object, ...], ...]
    pierces: tuple[tuple[object, ...], ...]
    first: int
    names: Mapping[str, str] = field(hash=False)
    profile: Profile = field(hash=False)
    dialect: Dialect = field(hash=False)


def body_of_plan(
    plan: Plan,
    names: Mapping[str, str],
    nest: Nest,
    profile: Profile,
    dialect: Dialect,
    paths: Sequence[Toolpath] | None = None,
) -> tuple[str, ...]:
    """All blocks but the comments at the top; the last ones asked for are kept with the nest.

    `names` are those of contours, the profile has the plan's origin, and `paths` are the plan's, where they are known.

    Raises
    ------
    InputError
        If the plan was made from another nest.
    """
    expect_same_nest(plan, profile.as_cut(nest))
    cuts = tuple((*_geometry(planned.cut), planned.dwell_s) for planned in plan.cuts)
    pierces, first = tuple((hole.contour, hole.at, hole.before) for hole in plan.pierces), plan.resumed_after + 1
    spelt = _Spelt(cuts, pierces, first, names, profile, dialect)
    known = nest.kept.setdefault(body_of_plan, OrderedDict())
    body: tuple[str, ...] | None = known.get(spelt)
    if body is None:
        paths = toolpaths(plan, nest, profile) if paths is None else paths
        body = tuple(_body(paths, names, nest, profile, dialect, first, plan.pierces))
        known.clear()
        known[spelt] = body
    return body


def blocks_of_plan(plan: Plan, nest: Nest, profile: Profile, paths: Sequence[Toolpath]) -> int:
    """How many blocks the program of a plan has, comments left out; see `body_of_plan`."""
    dialect = load_dialect(profile.machine.dialect)
    names = program_names(profile.as_cut(nest), dialect)
    return sum(not is_comment(block, dialect) for block in body_of_plan(plan, names, nest, profile, dialect, paths))


def _geometry(cut: Cut) -> tuple[object, ...]:
    """All of a cut but its times, its entry, and what it is excused from. Leads are told apart as objects."""
    ways = cut.pierce, cut.lead_in, cut.lead_out, cut.span, cut.tabs
    return cut.contour, cut.direction, *ways, cut.zone, cut.linked, cut.torch, cut.together


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
        made = made if x == y == 0 else replace(made, path=made.path.moved(-x, -y))
        yield from _cut(order, name, made, profile, pen, stays_on=lit)
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
        start_s = machine.unpierced_s if made.edge_start else machine.pierce_time_s
        start_s = machine.at_hole_s if made.pierced and not made.edge_start else start_s
        yield from pen.start(mark, (machine.mark_time_s if mark else start_s) if waits else 0.0, feed_mm_s)
    slowed = made.feed_share < 1.0
    yield from dialect.height_off if slowed else ()
    law = None if mark else profile.corner_feed()
    yield from pen.path(made.path, feed_mm_s, law, made.unlit)
    yield from dialect.height_on if slowed else ()
    yield from () if stays_on else pen.stop(mark)
