"""The step that makes one part of parts that bridges join."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import shapely

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Nest, Note, Part
from kerfwise.encoder.validate.inside import thick

from .bridge import Bridge
from .lawful import lawful
from .rings import joined_rings, ring_and_pocket

if TYPE_CHECKING:
    from collections.abc import Iterable


@dataclass(eq=False, slots=True)
class _Joined:
    """Some parts and the strips between them: ids in the order of the file, outline and pockets."""

    ids: list[str]
    outline: Curve
    pockets: list[Curve]


def with_bridges(nest: Nest) -> Nest:
    """The nest with the parts that its bridges join as one part each; the nest itself where it has none.

    Parts A and B become part `A+B` with the contour `A+B.outer`, in the place of the first of them; holes, marks and
    tabs keep names and places. Waste that two bridges enclose is a hole, `A+B.hole1`. The parts as they were drawn are
    kept as `apart`.

    Raises
    ------
    InputError
        For the first bridge that cannot be made, with its line.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> plate = nest(100, 50, part("A", rect(5, 5, 30, 20)), part("B", rect(45, 5, 30, 20)))
    >>> made = with_bridges(replace(plate, bridges=(Bridge(("A", "B"), (35, 15), (45, 15), 4.0, 1),)))
    >>> [c.id for c in made.contours], made.contour("A+B.outer").polygon.area
    (['A+B.outer'], 1240.0)
    """
    if not nest.bridges:
        return nest
    made: list[Bridge] = []
    parts = {p.id: p for p in nest.parts}
    place = {p.id: k for k, p in enumerate(nest.parts)}
    groups = {p.id: _Joined([p.id], p.outer.curve.towards("ccw"), []) for p in nest.parts}
    for drawn in nest.bridges:
        bridge = lawful(drawn, parts, made, nest.sheet)
        one, other = (groups[name] for name in bridge.parts)
        before = shapely.union_all([one.outline.polygon(), other.outline.polygon(), bridge.strip])
        pockets: list[Curve] = []
        if one is other:
            one.outline, *pockets = ring_and_pocket(bridge, one.outline)
        else:
            one.outline = joined_rings(bridge, one.outline, other.outline)
            one.ids = sorted((*one.ids, *other.ids), key=place.__getitem__)
            one.pockets += other.pockets
            groups |= dict.fromkeys(one.ids, one)
        _expect_union(bridge, one.outline, pockets, before)
        one.pockets += pockets
        made.append(bridge)
    whole = _in_place(nest.parts, groups)
    renamed = {f"{p.id}.outer": f"{_id(groups[p.id])}.outer" for p in nest.parts}
    return replace(
        nest,
        parts=whole,
        bridges=tuple(made),
        apart=nest.parts,
        notes=(*(_renamed(note, renamed) for note in nest.notes), *_differ(whole, groups, parts)),
    )


def _expect_union(bridge: Bridge, outline: Curve, pockets: Sequence[Curve], asked: shapely.Geometry) -> None:
    """The outline is what the areas together are; any other is not to be cut."""
    own = shapely.Polygon(outline.flatten(), [pocket.flatten() for pocket in pockets])
    if not own.is_valid or thick(shapely.symmetric_difference(own, asked)):
        raise bridge.refused("does not join the two outlines to one that can be cut: draw it elsewhere")


def _in_place(parts: Sequence[Part], groups: dict[str, _Joined]) -> tuple[Part, ...]:
    """Each group as a part, where its first part is."""
    of, taken = {p.id: p for p in parts}, {p.id for p in parts}
    whole = []
    for part in parts:
        group = groups[part.id]
        if len(group.ids) == 1:
            whole.append(part)
        elif group.ids[0] == part.id:
            if (name := _id(group)) in taken:
                raise InputError(f"bridges join parts to one called '{name}', and the nest has a part of that name")
            whole.append(_part(name, [of[one] for one in group.ids], group))
    return tuple(whole)


def _id(group: _Joined) -> str:
    return "+".join(group.ids)


def _part(name: str, drawn: Sequence[Part], group: _Joined) -> Part:
    def own(contours: Iterable[Contour]) -> tuple[Contour, ...]:
        return tuple(replace(contour, part=name) for contour in contours)

    pockets = [Contour(f"{name}.hole{k}", name, "hole", curve) for k, curve in enumerate(group.pockets, 1)]
    attributes: dict[str, object] = {}
    for part in drawn:
        attributes = part.attributes | attributes
    return Part(
        name,
        Contour(f"{name}.outer", name, "outer", group.outline),
        (*own(hole for part in drawn for hole in part.holes), *pockets),
        own(mark for part in drawn for mark in part.marks),
        attributes,
        tabs=tuple(tab for part in drawn for tab in part.tabs),
    )


def _renamed(note: Note, names: dict[str, str]) -> Note:
    return replace(note, contours=tuple(names.get(one, one) for one in note.contours))


def _differ(whole: Sequence[Part], groups: dict[str, _Joined], parts: dict[str, Part]) -> list[Note]:
    """A word on each attribute that parts of one group say differently; the first in the file counts."""
    told = []
    for part in whole:
        ids = () if part.id in parts else next(group.ids for group in groups.values() if _id(group) == part.id)
        for name in ids:
            for key, value in parts[name].attributes.items():
                if value != part.attributes[key]:
                    text = f"part {name}, which bridges join to {part.id}, has another '{key}' than a part before it"
                    told.append(Note("warning", f"{text}: that of the earlier one counts"))
    return told
