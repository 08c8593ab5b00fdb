"""What geometry finds wrong with a whole order, as statements against it; loose metal whatever the profile says."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np
import shapely

from kerfwise.encoder.display import join_names
from kerfwise.encoder.nest import Nest, cached_with_nest
from kerfwise.rules.judging.loose_metal import OVER_MM, beside_metal, crumbs, loosened, meeting
from kerfwise.rules.rule import NoGoodIds, Rule
from kerfwise.rules.statements import EXEMPTION_MM, About, NoGood, Precede, Statement, by_kind

from .reduced_statements import GantryStatements, Remainder, remaining_no_good, rest_of

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Copies, Facts
    from kerfwise.rules.profile.active_rules import ActiveRules


# What geometry finds wrong with a whole order, as statements against it: for rules that no statement can say before.
#
# A narrow strip, say, comes of everything that is already cut; the order is judged when it is there, and what is
# wrong with it must not occur again (Petunin 2009, fig. 3).

SAMPLE, SAMPLE_S = 16, 0.05
"""Contours in a first sample of a look; samples become longer until one takes so many seconds."""
LATER = 1.5
"""How much longer the same number of cuts takes to look at later on, when more is out."""


LARGE = 300
"""Of fewer contours little is measured before a look."""

Look = Callable[[Sequence[int]], tuple[Statement, ...]]
"""Says what is wrong with an order (contour numbers)."""


@contextmanager
def measured_beside(make: Callable[[], Look], contours: int) -> Iterator[Look]:
    """The look that is made; what every look needs of a large nest, whatever the order, a thread finds out meanwhile.

    It has a look of its own, as one tells each thing once. Where that fails, the one at an order says why.
    """
    look = make()
    if contours < LARGE:
        yield look
        return
    with ThreadPoolExecutor(1) as thread:
        measured = thread.submit(make(), ())

        def looked(order: Sequence[int]) -> tuple[Statement, ...]:
            wait([measured])
            return look(order)

        yield looked


def lazy_statements(facts: Facts, profile: ActiveRules) -> Look:
    """A function that says what is wrong with an order (contour numbers), each thing once.

    It answers with nothing when an order shows nothing new: a soft rule, or one that is excusable, may well be broken
    again, at its price.
    """
    nest, whole, book = facts.nest, facts.whole_nest, profile.rulebook()
    index, rest, cut_before = whole.index, rest_of(facts), [cut.contour for cut in facts.already_cut]
    reported: set[tuple[str, frozenset[int], frozenset[int]]] = set()
    enclosing: set[tuple[str, ...]] = set()

    def look(order: Sequence[int]) -> tuple[Statement, ...]:
        found: list[Statement] = []
        for names in _in_turn(facts, [*cut_before, *(nest.contours[k].id for k in order)]):
            found += looked(names)
            found += in_loose_metal(names)
        return tuple(found)

    def looked(names: Sequence[str]) -> Iterator[Statement]:
        contours = [name for name in names if name in index] if nest.stretches else names
        for name, setting in profile.settings().items():
            for wrong in book[name].no_goods(whole, contours, setting.options):
                out, left = frozenset(index[k] for k in wrong.out), frozenset(index[k] for k in wrong.left)
                if (name, out, left) not in reported:
                    reported.add((name, out, left))
                    about = book[name].about((*wrong.out, *wrong.left), wrong.sentence)
                    hard = EXEMPTION_MM if book[name].excusable else None
                    seen = NoGood(out, left, about, hard if setting.weight is None else setting.weight)
                    yield from remaining_no_good(seen, rest) if facts.copies is None else _of_first(facts.copies, seen)

    def in_loose_metal(names: Sequence[str]) -> Iterator[Statement]:
        for statement in enclosed(facts, rest, names):
            if (names_of := statement.about.contours) not in enclosing:
                enclosing.add(names_of)
                yield statement

    return look


def looks_at_orders(facts: Facts, profile: ActiveRules) -> bool:
    """Whether some rule that is on says of whole orders what it does not state."""
    book = profile.rulebook()
    return any(type(book[name]).no_goods is not Rule.no_goods for name in profile.settings())


def forbids_later(facts: Facts, profile: ActiveRules) -> bool:
    """Whether something forbids what only geometry finds in a whole order; what has a price does not.

    A rule of the profile may, and whatever it says: kerfs that meet may cut metal off.
    """
    if meeting_of(facts.nest_with_ways, facts.options.kerf_mm):
        return True
    book = profile.rulebook()
    hard = (book[name] for name, setting in profile.settings().items() if setting.weight is None)
    return any(type(rule).no_goods is not Rule.no_goods and not rule.excusable for rule in hard)


def _of_first(copies: Copies, seen: NoGood) -> Iterator[Statement]:
    """A no-good about the whole nest in terms of the first torch; one that no order avoids is the check's to tell."""
    yield from GantryStatements(copies).of_first([seen])


def _in_turn(facts: Facts, names: list[str]) -> Iterator[list[str]]:
    """The order of all contours, given that of the first torch: of what is cut together each comes first once."""
    copies = facts.copies
    if copies is None:
        yield names
        return
    ids = [contour.id for contour in copies.whole.nest.contours]
    together = {ids[group.contours[0]]: [ids[k] for k in group.contours] for group in copies.groups}
    for turn in range(max((len(row) for row in together.values()), default=1)):
        rows = (together.get(name, [name]) for name in names)
        yield [name for row in rows for name in (*row[turn % len(row) :], *row[: turn % len(row)])]


def look_takes_s(facts: Facts, profile: ActiveRules, clock: Callable[[], float] = time.monotonic) -> float:
    """About how many seconds a look at one order takes: from looks at stretches of an order.

    Each stretch is another, as what a look has told of some parts is known to the next.
    """
    nest, book = facts.whole_nest, profile.rulebook()
    names = [contour.id for contour in nest.contours]

    def looked_s(stretch: Sequence[str]) -> float:
        began_s = clock()
        for name, setting in profile.settings().items():
            book[name].no_goods(nest, stretch, setting.options)
        return clock() - began_s

    first_s = looked_s(names[:1])  # the first cut tells what every look takes before it begins
    begin, count = 1, SAMPLE
    while (took_s := looked_s(names[begin : begin + count])) - first_s < SAMPLE_S and begin + count < len(names):
        begin, count = begin + count, 2 * count
    looked = max(min(count, len(names) - begin), 1)
    return first_s + LATER * max(took_s - first_s, 0.0) * len(names) / looked


# What no profile turns off: nothing is cut in metal that has come loose, so that what lies in it is cut before.
#
# Which metal comes loose is seen from the kerfs (`rules/judging/loose`); the check sees it on the burns of a program.

LOOSE_METAL = "loose-metal"
"""What these statements come from: no rule, but a promise about the metal (docs/safety.md)."""
_NAMED = 6


def in_held_metal(facts: Facts, rest: Remainder, stated: Iterable[Statement]) -> Iterator[Statement]:
    """What must hold of every order, beside what is `stated` already: what lies in a contour is cut before it.

    So is what lies in metal that kerfs of several contours enclose: all of it that an order from the outside in shows.
    A contour with tabs leaves what lies in it where it is.
    """
    asked = {s.about.contours: s for s in _inner_first(facts)}
    known = {s.about.contours for s in by_kind(stated).precede if s.weight is None and s.about.contours in asked}
    inner = [s for contours, s in asked.items() if contours not in known]
    yield from inner if facts.copies is None else GantryStatements(facts.copies).of_first(inner)
    if meeting_of(facts.nest_with_ways, facts.options.kerf_mm):
        yield from enclosed(facts, rest, _any_order(facts))


def asked_of_torches(facts: Facts) -> Iterator[Statement]:
    """The same of what several torches cut, each contour by itself."""
    yield from _inner_first(facts)
    yield from _enclosed(facts, _any_order(facts))


def enclosed(facts: Facts, rest: Remainder, names: Sequence[str]) -> Iterator[Statement]:
    """What an order of all contours shows to be cut in metal that others have cut off, as statements against that."""
    for seen in _enclosed(facts, names):
        yield from (
            remaining_no_good(seen, rest) if facts.copies is None else GantryStatements(facts.copies).of_first([seen])
        )


def _inner_first(facts: Facts) -> Iterator[Precede]:
    of = facts if facts.copies is None else facts.copies.whole
    contours, held = of.nest.contours, facts.held_by_tabs
    for k, around in enumerate(of.parent.tolist()):
        inner, outer = contours[k].id, contours[around].id
        if around >= 0 and contours[k].kind != "mark" and outer not in held:
            sentence = f"{inner} is cut before {outer}: it lies inside it, and cutting {outer} frees the metal it is in"
            yield Precede(k, around, About(LOOSE_METAL, (inner, outer), sentence))


def _enclosed(facts: Facts, names: Sequence[str]) -> Iterator[NoGood]:
    whole = facts.nest_with_ways
    for wrong in no_goods(whole, names, facts.options.kerf_mm, facts.held_by_tabs):
        out, left = (frozenset(whole.index[name] for name in side) for side in (wrong.out, wrong.left))
        yield NoGood(out, left, About(LOOSE_METAL, (*wrong.out, *wrong.left), wrong.sentence))


def no_goods(nest: Nest, names: Sequence[str], kerf_mm: float, held: Collection[str] = ()) -> list[NoGoodIds]:
    """Contours of an order that lie in metal which those before them have cut off together, with these."""
    rings = meeting_of(nest, kerf_mm)
    order = [name for name in names if name in rings and name not in held]
    at = {name: k for k, name in enumerate(order)}
    if not order:
        return []
    faces = loosened(shapely.make_valid(nest.sheet.polygon), [rings[name] for name in order], kerf_mm)
    areas = np.array([face.area for face in faces], dtype=object)
    faces = [face for face, crumb in zip(faces, crumbs(areas).tolist(), strict=True) if not crumb] if faces else []
    cut_names = [name for name in names if nest.contour(name).kind not in ("mark", "scrap")]
    lines = np.array([_line(nest, name, kerf_mm) for name in cut_names], dtype=object)
    place = {name: k for k, name in enumerate(names)}
    tree = shapely.STRtree(lines)
    walls: dict[str, frozenset[str]] = {}
    for face in faces:
        late = [cut_names[k] for k in tree.query(face.area, "intersects").tolist()]
        late = [name for name in late if place[name] > place[order[face.since]] and name not in walls]
        late = [name for name in late if at.get(name, 0) <= face.gone]
        late = [name for name in late if _over_mm(nest, name, kerf_mm, face.area) > OVER_MM]
        if late:
            around = frozenset(order[k] for k in face.walls())
            walls |= {name: around for name in late if not _inside(nest, name, around)}
    return [NoGoodIds(tuple(sorted(out)), (name,), _said(name, sorted(out))) for name, out in sorted(walls.items())]


def _said(name: str, out: Sequence[str]) -> str:
    if len(out) == 1:
        return f"{name} is cut before {out[0]}: the kerf of that closes around the metal it is in, which would be loose"
    return (
        f"{name} is cut before the last of {join_names(out, _NAMED)}: "
        f"their kerfs meet around the metal it is in, which "
        "would be loose"
    )


def _inside(nest: Nest, name: str, around: frozenset[str]) -> bool:
    """Whether one contour alone lies around another: that is an order of its own."""
    if len(around) != 1:
        return False
    (outer,) = (nest.contour(one) for one in around)
    return outer.encloses and bool(outer.polygon.intersects(shapely.Point(nest.contour(name).curve.vertices[0, :2])))


def _over_mm(nest: Nest, name: str, kerf_mm: float, area: shapely.Polygon) -> float:
    return float(shapely.intersection(_beside_metal(nest, kerf_mm)[name], area).length)


def _line(nest: Nest, name: str, kerf_mm: float) -> shapely.LineString:
    return torch_lines(nest, kerf_mm)[name]


@cached_with_nest(most=1)
def meeting_of(nest: Nest, kerf_mm: float) -> dict[str, shapely.LineString]:
    """The torch's way round each contour whose kerf meets that of another, itself, or the border: by id.

    Scrap lines are not among them: rule scrap-last sees to what they cut off.
    """
    lines = torch_lines(nest, kerf_mm)
    names = list(lines)
    together = meeting(shapely.make_valid(nest.sheet.polygon), list(lines.values()), kerf_mm)
    return {names[k]: lines[names[k]] for k in together}


@cached_with_nest(most=1)
def _beside_metal(nest: Nest, kerf_mm: float) -> dict[str, shapely.Geometry]:
    """What of each torch's way round does not run in the metal of parts, as it does where they stand too near."""
    lines = torch_lines(nest, kerf_mm)
    metal = np.array([shapely.make_valid(part.polygon) for part in nest.parts], dtype=object)
    return dict(zip(lines, beside_metal(list(lines.values()), metal, kerf_mm), strict=True))


@cached_with_nest(most=1)
def torch_lines(nest: Nest, kerf_mm: float) -> dict[str, shapely.LineString]:
    """Where the torch goes round each contour that it cuts through, by id."""
    cut = [contour for contour in nest.contours if contour.kind not in ("mark", "scrap")]
    around = [contour for contour in cut if contour.encloses]
    by_mm = np.array([kerf_mm / 2 if contour.kind == "outer" else -kerf_mm / 2 for contour in around])
    areas = shapely.make_valid(np.array([contour.polygon for contour in around], dtype=object))
    grown, of = shapely.get_parts(shapely.buffer(areas, by_mm), return_index=True)
    order = np.lexsort((-shapely.area(grown), of))
    largest = order[np.flatnonzero(np.diff(of[order], prepend=-1))]
    rounds = dict(zip(of[largest].tolist(), shapely.get_exterior_ring(grown[largest]), strict=True))
    ways = {contour.id: rounds.get(k) for k, contour in enumerate(around)}
    lines = ((contour.id, ways[contour.id] if contour.encloses else contour.line) for contour in cut)
    return {name: line for name, line in lines if line is not None}


def _any_order(facts: Facts) -> list[str]:
    """An order of all contours that shows much of what others enclose.

    After the cuts that are made comes what lies nearest to the border, and what lies in others before them.
    """
    of = facts.copies.whole if facts.copies is not None else facts.past.whole if facts.past is not None else facts
    contours, parent = of.nest.contours, of.parent.tolist()
    middle = of.nest.sheet.polygon.centroid

    def key(k: int) -> tuple[float, int, int]:
        depth, top = 0, k
        while parent[top] >= 0:
            depth, top = depth + 1, parent[top]
        return -float(contours[top].line.distance(middle)), top, -depth

    cut_before = [*(cut.contour for cut in facts.already_cut), *(way.id for way in of.nest.stretches)]
    left = sorted((k for k, contour in enumerate(contours) if contour.id not in set(cut_before)), key=key)
    return [*cut_before, *(contours[k].id for k in left)]
