"""DXF entities as curves: arcs stay arcs, splines and ellipses become arcs again; names, looks, and what is not
read."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise

import numpy as np
import shapely
from ezdxf.colors import aci2rgb
from ezdxf.document import Drawing as Document
from ezdxf.entities.arc import Arc
from ezdxf.entities.attrib import AttDef
from ezdxf.entities.circle import Circle
from ezdxf.entities.dxfentity import DXFEntity, DXFTagStorage
from ezdxf.entities.dxfgfx import DXFGraphic
from ezdxf.entities.dxfns import DXFNamespace
from ezdxf.entities.ellipse import Ellipse
from ezdxf.entities.insert import Insert
from ezdxf.entities.line import Line
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.entities.mtext import MText
from ezdxf.entities.point import Point
from ezdxf.entities.polyline import Polyline
from ezdxf.entities.spline import Spline
from ezdxf.entities.text import Text
from ezdxf.math import OCS, BSpline, ConstructionEllipse, Vec3
from ezdxf.path import Path, make_path
from ezdxf.transform import copies
from ezdxf.xclip import XClip

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Note

from .clipping import Clips
from .drawing import FAREST_MM, LIMIT_MM, WRONG_UNITS, checked_curve
from .dxf_text import is_written, name_of, plain_text
from .fit_arcs import FLATTEN_MM, fit_curve
from .layers import Layers, counted

# Only what can be cut is read. Whatever else is drawn is counted, so that its absence can be said aloud.

EVERYWHERE = 1e9
"""Half the side of a square that holds all that can be read, in any unit."""
EXTERNAL = 4
"""The bit in a block's flags that says that its lines are in another file."""
ROUND = 1e-6
"""An ellipse whose axes differ by less than this share is a circle."""
NO_TURN = 1e-9
"""Angles that differ by less than this, rad, are one: an arc between them is a circle."""
SCALES = ("xscale", "yscale", "zscale")
NOTHING = 1e-9
"""A scale under this is 0: of a block of a kilometre it leaves a micrometre."""


@dataclass(frozen=True, slots=True)
class Hidden:
    """The layers that are not shown, in lower case: what is inserted on one that is `off` has its own."""

    off: frozenset[str] = frozenset()
    frozen: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Placed:
    """An entity to read, its layer, the areas that it is seen through in units of the drawing, where blocks are
    clipped, the names of the blocks that it lies in, outermost first, and what their attributes say. `inside` is the
    insertion of the block that it lies in."""

    entity: DXFGraphic
    layer: str
    clips: Clips = ()
    blocks: tuple[str, ...] = ()
    attributes: tuple[tuple[str, str], ...] = ()
    inside: Placed | None = None


def entities(
    drawn: Iterable[DXFGraphic], hidden: Hidden, unread: Unread, within: Placed | None = None
) -> Iterator[Placed]:
    """Every entity to read, writing and points too, blocks taken apart (scaled, mirrored and nested ones too).

    An entity on layer 0 of a block lies on the layer of its insertion, which `within` tells of. Blocks must not contain
    themselves (`check_copies`).
    """
    for entity in drawn:
        layer = layer_of(entity)
        if within is not None and layer == "0":
            layer = within.layer
        is_insert = isinstance(entity, Insert)
        if layer.lower() in hidden.frozen or (layer.lower() in hidden.off and not is_insert) or _invisible(entity):
            unread.hidden(entity, layer)
        elif is_written(entity) or isinstance(entity, Point):
            yield _placed(entity, layer, within)
        elif entity.dxftype() in NO_LINES:
            unread.add(entity, layer)
        elif isinstance(entity, Insert):
            placed = _placed(entity, layer, within)
            attributes = tuple((name_of(str(a.dxf.tag)), plain_text(a)) for a in entity.attribs)
            placed = replace(
                placed,
                clips=(*placed.clips, *_clip(entity)),
                blocks=(*placed.blocks, name_of(str(entity.dxf.name))),
                attributes=(*placed.attributes, *attributes),
            )
            for insert in _inserted(entity, layer, unread):
                if _skews(insert):
                    yield from _skewed(insert, hidden, unread, placed)
                else:
                    skip = partial(_skipped, unread=unread, layer=layer)
                    inner = insert.virtual_entities(skipped_entity_callback=skip)
                    yield from entities(inner, hidden, unread, placed)
                yield from _attributes(insert, entity, hidden, placed)
        else:
            yield _placed(entity, layer, within)


def _skews(insert: Insert) -> bool:
    """Whether a block in it is turned and then scaled unequally, of which ezdxf makes an insertion that is wrong, or
    scaled by 0, of which it makes one at scale 1."""
    wide, high = abs(insert.dxf.xscale), abs(insert.dxf.yscale)
    equal = abs(wide - high) <= ROUND * wide
    inner = [one for one in insert.block() or () if isinstance(one, Insert)]
    turned = not equal and any(abs((one.dxf.rotation + 45) % 90 - 45) > ROUND for one in inner)
    return turned or any(abs(one.dxf.get(axis, 1.0)) < NOTHING for one in inner for axis in SCALES)


def _skewed(insert: Insert, hidden: Hidden, unread: Unread, placed: Placed) -> Iterator[Placed]:
    """What is in a block, taken apart in the block's own place first, and then moved."""
    matrix = insert.matrix44()
    axes = np.array([v.vec2 for v in matrix.transform_directions([Vec3(1, 0), Vec3(0, 1)])])
    to = np.array(matrix.transform(Vec3()).vec2)
    drawn = (one for one in insert.block() or () if isinstance(one, DXFGraphic) and not isinstance(one, AttDef))
    for one in entities(drawn, hidden, unread, replace(placed, clips=())):
        clips = (*placed.clips, *(shapely.transform(a, lambda points: points @ axes + to) for a in one.clips))
        for moved in (each for each in copies([one.entity], matrix)[1] if isinstance(each, DXFGraphic)):
            yield replace(one, entity=moved, clips=clips)


def _placed(entity: DXFGraphic, layer: str, within: Placed | None) -> Placed:
    return Placed(entity, layer) if within is None else replace(within, entity=entity, layer=layer, inside=within)


def _attributes(insert: Insert, first: Insert, hidden: Hidden, placed: Placed) -> Iterator[Placed]:
    """The attributes that an insertion shows; of a row of them each copy has its own. Constant ones are its block's."""
    for definition in insert.block() or ():
        if isinstance(definition, AttDef) and is_written(definition):
            layer = layer_of(definition)
            shown = definition.copy()
            shown.transform(insert.matrix44())
            yield _placed(shown, placed.layer if layer == "0" else layer, placed)
    for attribute in insert.attribs:
        layer = layer_of(attribute)
        layer = placed.layer if layer == "0" else layer
        if attribute.is_invisible or _invisible(attribute) or layer.lower() in hidden.off | hidden.frozen:
            continue
        if insert is not first and attribute.dxf.hasattr("align_point"):  # the library moves the other point only
            attribute.dxf.align_point += insert.dxf.insert - first.dxf.insert
        yield _placed(attribute, layer, placed)


def _clip(insert: Insert) -> Clips:
    """The area that an insertion is seen through, where it is clipped."""
    clip = XClip(insert)
    if not (clip.has_clipping_path and clip.is_clipping_enabled):
        return ()
    path = clip.get_wcs_clipping_path()
    inner = [(v.x, v.y) for v in path.inner_polygon()]
    if len(inner) == 2:  # two opposite corners of a rectangle
        (ax, ay), (bx, by) = inner
        inner = [(ax, ay), (bx, ay), (bx, by), (ax, by)]
    if len(inner) < 3:
        return ()
    area = shapely.make_valid(shapely.Polygon(inner))
    if path.is_inverted_clip:
        return (shapely.difference(shapely.box(-EVERYWHERE, -EVERYWHERE, EVERYWHERE, EVERYWHERE), area),)
    return (area,)


def _inserted(insert: Insert, layer: str, unread: Unread) -> Iterable[Insert]:
    """Each copy that an INSERT makes, none where there is nothing to copy; heights do not matter, so neither do theirs.

    Some CAD systems write a scale of 0 for the height of what is flat; the scale of a plane is not 0.
    """
    block = insert.block()
    if block is None or block.block is None:
        unread.types["INSERT of a block that the file does not hold", layer] += insert.mcount
        return ()
    if block.block.dxf.get("flags", 0) & EXTERNAL:
        unread.types["INSERT of another file (XREF)", layer] += insert.mcount
        return ()
    if min(abs(insert.dxf.xscale), abs(insert.dxf.yscale)) < NOTHING:
        unread.types["INSERT of a block at scale 0", layer] += insert.mcount
        return ()
    for entity in block:
        if isinstance(entity, DXFTagStorage):  # the library copies all but these, and says nothing of them
            unread.types[entity.dxftype(), layer] += insert.mcount
    if abs(insert.dxf.zscale) < NOTHING:
        unread.flattened += insert.mcount
        insert.dxf.zscale = 1.0
    return insert.multi_insert() if insert.mcount > 1 else (insert,)


def _skipped(entity: DXFGraphic, reason: str, *, unread: Unread, layer: str) -> None:
    unread.add(entity, layer)


def _invisible(entity: DXFGraphic) -> bool:
    return bool(entity.dxf.is_supported("invisible") and entity.dxf.get("invisible", 0))


def curve(entity: DXFGraphic, scale: float) -> Curve | None:
    """The entity as a curve in mm, or None for one that cannot be cut.

    Parameters
    ----------
    entity
        A DXF entity, in world coordinates or its own (an extrusion of -Z mirrors it).
    scale
        Millimetres per drawing unit.
    """
    match entity:
        case Line():
            start, end = entity.dxf.start, entity.dxf.end
            return checked_curve([(start.x, start.y), (end.x, end.y)], False, scale)
        case Ellipse():
            return _ellipse(entity.construction_tool(), scale)
        case Spline():
            spline = entity.construction_tool()
            return _flattened(spline if spline.is_clamped else Unclamped(spline), spline.control_points, scale)
        case Polyline() if entity.is_3d_polyline:
            return _polyline(OCS(), [(*v.location, 0.0) for v in _vertices(entity)], entity.is_closed, 1.0, scale)
        case Arc() | Circle() | LWPolyline():
            pass
        case Polyline() if entity.is_2d_polyline:
            pass
        case _:
            return None
    if is_tilted(entity):
        path = make_path(entity)
        return _flattened(path, path.control_vertices(), scale)
    match entity:
        case Arc():
            a0, a1 = math.radians(entity.dxf.start_angle), math.radians(entity.dxf.end_angle)
            sweep = (a1 - a0) % math.tau
            return _arc(entity, a0, sweep if sweep > NO_TURN else math.tau, _tilt(entity), scale)
        case Circle():
            return _arc(entity, 0.0, math.tau, _tilt(entity), scale)
        case LWPolyline():
            points = [(x, y, 0.0, b) for x, y, b in entity.get_points("xyb")]
            return _polyline(entity.ocs(), points, entity.closed, _tilt(entity), scale)
        case _:
            points = [(*v.location, float(v.get("bulge", 0.0))) for v in _vertices(entity)]
            return _polyline(entity.ocs(), points, entity.is_closed, _tilt(entity), scale)


FLAT = (Arc, Circle, Ellipse, LWPolyline, Text, MText)
"""Types that are drawn on a plane of their own."""


def _tilt(entity: DXFGraphic) -> float:
    """How far the plane of an entity is seen from its front: 1, from behind -1, from its edge 0."""
    return float(Vec3(entity.dxf.get("extrusion", (0, 0, 1))).normalize().z)


def is_tilted(entity: DXFGraphic) -> bool:
    """Whether the plane that an entity is drawn on is seen at an angle from above."""
    is_flat = entity.is_2d_polyline if isinstance(entity, Polyline) else isinstance(entity, FLAT)
    return is_flat and abs(abs(_tilt(entity)) - 1) > ROUND


def _vertices(line: Polyline) -> list[DXFNamespace]:
    """The vertices of a POLYLINE; the control points (16) of a smoothed one are no part of the line."""
    return [v.dxf for v in line.vertices if not v.dxf.get("flags", 0) & 16]


def points_in_space(entity: DXFGraphic) -> list[Vec3]:
    """The points of a line that need lie on no plane: ends, vertices, control points of a spline; [] for all others."""
    if isinstance(entity, Line):
        return [entity.dxf.start, entity.dxf.end]
    if isinstance(entity, Spline):
        return list(Vec3.generate(entity.control_points if len(entity.control_points) else entity.fit_points))
    if isinstance(entity, Polyline) and entity.is_3d_polyline:
        return [v.location for v in _vertices(entity)]
    if isinstance(entity, Polyline) and entity.is_2d_polyline and not is_tilted(entity):
        return list(entity.ocs().points_to_wcs(v.location for v in _vertices(entity)))
    return []


def _arc(circle: Circle, start_rad: float, sweep_rad: float, tilt: float, scale: float) -> Curve:
    ocs, centre, radius = circle.ocs(), Vec3(circle.dxf.center), circle.dxf.radius
    angles = (start_rad, start_rad + sweep_rad / 2, start_rad + sweep_rad)
    return _bent([ocs.to_wcs(centre + Vec3.from_angle(a, radius)) for a in angles], sweep_rad, tilt, scale)


def _bent(rim: Sequence[Vec3], sweep_rad: float, tilt: float, scale: float) -> Curve:
    """An arc by its start, middle and end, halved if over a half-circle; a full turn is a closed curve."""
    shares = 1 if sweep_rad <= math.pi else 2
    bulge = math.copysign(math.tan(sweep_rad / (4 * shares)), tilt)
    rows = [(p.x, p.y, bulge) for p in (rim[0], rim[1], rim[2])]
    closed = sweep_rad >= math.tau - NO_TURN
    return checked_curve(rows[:2] if closed else rows[:: 3 - shares], closed, scale)


def _polyline(ocs: OCS, points: Sequence[tuple[float, ...]], closed: bool, tilt: float, scale: float) -> Curve | None:
    """A curve of (x, y, z, bulge); a bulge turns the other way on a plane seen from behind."""
    if len(points) < 2:
        return None
    world = [ocs.to_wcs(Vec3(p[:3])) for p in points]
    rows = [(w.x, w.y, math.copysign(1.0, tilt) * p[3]) for w, p in zip(world, points, strict=True)]
    return checked_curve(rows, closed, scale)


def _ellipse(ellipse: ConstructionEllipse, scale: float) -> Curve | None:
    """A circle or arc where the axes are equal, else fitted arcs."""
    tilt, sweep = ellipse.extrusion.z, ellipse.param_span
    if not NO_TURN < sweep < math.tau - NO_TURN:  # ezdxf draws none that begins anywhere but at 0
        ellipse, sweep = (
            ConstructionEllipse(ellipse.center, ellipse.major_axis, ellipse.extrusion, ellipse.ratio),
            math.tau,
        )
    if abs(ellipse.ratio - 1) < ROUND and abs(abs(tilt) - 1) < ROUND:
        params = [ellipse.start_param + sweep * f for f in (0.0, 0.5, 1.0)]
        return _bent(list(ellipse.vertices(params)), sweep, tilt, scale)
    return _flattened(ellipse, [ellipse.center, ellipse.center + ellipse.major_axis], scale)


def _flattened(
    drawn: BSpline | Unclamped | ConstructionEllipse | Path, control: Iterable[Vec3], scale: float
) -> Curve | None:
    """Fitted arcs through a curve that DXF draws and no machine can; `control` points bound its extent."""
    bounds = list(control)
    for p in bounds:  # flattening a curve of astronomic size would never end
        if not max(abs(p.x), abs(p.y), abs(p.z)) * scale <= FAREST_MM:
            raise InputError(f"({p.x:g}, {p.y:g}) lies more than 10,000 kilometres from the origin: {WRONG_UNITS}")
    if max((bounds[0].distance(p) for p in bounds), default=0.0) * scale > LIMIT_MM:  # one so large takes seconds
        checked_curve([(p.x, p.y) for p in drawn.flattening(LIMIT_MM / scale, 8)], False, scale)
    return fit_curve(np.array([(p.x, p.y) for p in drawn.flattening(FLATTEN_MM / scale, 8)]) * scale)


# Splines whose knots go on beyond their ends, as CAD systems write closed ones.

_DEEPEST = 16


@dataclass(frozen=True, slots=True)
class Unclamped:
    """A spline that is no curve over its first and last knots, as many as its degree; ezdxf would draw it there too."""

    spline: BSpline

    def flattening(self, distance: float, segments: int = 4) -> Iterator[Vec3]:
        """Points along the curve, no chord between them further off it than about `distance`."""
        knots, degree = self.spline.knots(), self.spline.order - 1
        ends = np.unique(knots[degree : self.spline.count + 1])
        times = np.unique(np.concatenate([np.linspace(a, b, segments + 1) for a, b in pairwise(ends)]))
        points = [self._at(t) for t in times]
        yield points[0]
        for k in range(len(times) - 1):
            yield from self._finer(times[k], points[k], times[k + 1], points[k + 1], distance, _DEEPEST)

    def _at(self, time: float) -> Vec3:
        return self.spline.evaluator.point(float(time))

    def _finer(self, t0: float, start: Vec3, t1: float, end: Vec3, distance: float, depth: int) -> Iterator[Vec3]:
        middle = self._at((t0 + t1) / 2)
        # the middle of a short piece of a smooth curve lies beside that of its chord
        if depth == 0 or middle.distance(start.lerp(end)) <= distance:
            yield end
        else:
            yield from self._finer(t0, start, (t0 + t1) / 2, middle, distance, depth - 1)
            yield from self._finer((t0 + t1) / 2, middle, t1, end, distance, depth - 1)


# What a DXF file shows and kerfwise does not read: dimensions, fillings, what nobody knows.

NO_LINES = frozenset(
    (
        *("TEXT", "MTEXT", "RTEXT", "ATTRIB", "ARCALIGNEDTEXT", "ATTDEF", "SHAPE", "TOLERANCE", "ACAD_TABLE"),
        *("POINT", "RAY", "XLINE", "VIEWPORT"),
        *("DIMENSION", "ARC_DIMENSION", "LARGE_RADIAL_DIMENSION", "LEADER", "MLEADER", "MULTILEADER"),
        *("HATCH", "MPOLYGON", "SOLID", "TRACE", "WIPEOUT", "IMAGE", "OLE2FRAME", "PDFUNDERLAY"),
    )
)
"""Types of entity that are no lines one could cut along."""


@dataclass(slots=True)
class Unread:
    """What was passed over on the way.

    `types` counts by entity type and layer, `hidden_layers` by layer; `flattened` counts blocks whose height was scaled
    by 0.
    """

    types: Counter[tuple[str, str]] = field(default_factory=Counter)
    hidden_layers: Counter[str] = field(default_factory=Counter)
    flattened: int = 0

    def add(self, entity: DXFEntity, layer: str) -> None:
        """Count an entity that is not read."""
        self.types[entity.dxftype(), layer] += 1

    def hidden(self, entity: DXFEntity, layer: str) -> None:
        """Count an entity that is not shown, if it could have been cut."""
        if entity.dxftype() not in NO_LINES:
            self.hidden_layers[layer] += 1

    def notes(self, layers: Layers) -> list[Note]:
        """A word on each, but not on what is no line on layers that are left out anyway."""
        notes = []
        seen = Counter[str]()
        for (kind, layer), count in self.types.items():
            if kind not in NO_LINES or layers.use([layer]).purpose != "ignore":
                seen[kind] += count
        if seen:
            listed = ", ".join(f"{n} {kind}" for kind, n in sorted(seen.items()))
            text = f"left out, as they are not lines one can cut: {listed}; explode them in CAD if they are to be cut"
            notes.append(Note("warning", text))
        if self.flattened:
            blocks = f"{self.flattened} blocks are" if self.flattened > 1 else "1 block is"
            notes.append(Note("warning", f"{blocks} inserted with a height scale of 0: read as flat"))
        if self.hidden_layers:
            hidden = counted(self.hidden_layers.elements())
            notes.append(Note("warning", f"left out, as they are invisible or their layer is off or frozen: {hidden}"))
        return notes


def layer_of(entity: DXFEntity) -> str:
    """The layer of an entity, also of a type that nobody knows, as its author wrote it."""
    if isinstance(entity, DXFTagStorage):
        return name_of(next((str(tag.value) for part in entity.xtags.subclasses for tag in part if tag.code == 8), "0"))
    return name_of(str(entity.dxf.get("layer", "0"))) if entity.dxf.is_supported("layer") else "0"


# How an entity of a DXF file looks: its colour and its line type, its own or those of its layer.

NAMES = {1: "red", 2: "yellow", 3: "green", 4: "cyan", 5: "blue", 6: "magenta", 7: "white", 8: "grey"}
"""The colours that CAD programs number first; 7 is drawn white on black and black on white."""
BY_BLOCK, BY_LAYER = 0, 256
CONTINUOUS = ("", "continuous", "bylayer", "byblock")


class Looks:
    """Colours and line types of a document's entities."""

    def __init__(self, document: Document) -> None:
        rows = [(name_of(str(x.dxf.name)).lower(), x) for x in document.layers]
        self._colours = {name: _named(abs(int(x.dxf.get("color", 7)))) for name, x in rows}
        self._linetypes = {name: str(x.dxf.get("linetype", "Continuous")) for name, x in rows}

    def colour(self, placed: Placed) -> str:
        """The name of a colour, #rrggbb where it has none: an entity's own, its layer's, or that of its block."""
        entity = placed.entity
        if entity.dxf.hasattr("true_color"):
            return f"#{int(entity.dxf.true_color) & 0xFFFFFF:06x}"
        number = int(entity.dxf.get("color", BY_LAYER)) if entity.dxf.is_supported("color") else BY_LAYER
        if number == BY_LAYER:
            return self._colours.get(placed.layer.lower(), "white")
        if number == BY_BLOCK:
            return "white" if placed.inside is None else self.colour(placed.inside)
        return _named(abs(number))

    def linetype(self, placed: Placed) -> str:
        """The name of a line type, "" where lines are drawn through."""
        entity = placed.entity
        own = str(entity.dxf.get("linetype", "BYLAYER")) if entity.dxf.is_supported("linetype") else "BYLAYER"
        if own.lower() == "byblock":
            return "" if placed.inside is None else self.linetype(placed.inside)
        kind = self._linetypes.get(placed.layer.lower(), "") if own.lower() == "bylayer" else own
        return "" if kind.lower() in CONTINUOUS else kind


def width_of(entity: DXFGraphic) -> float:
    """How wide a polyline is drawn where it is widest, in units of the drawing; 0 for a line of no width."""
    if isinstance(entity, LWPolyline):
        widths = [w for pair in entity.get_points("se") for w in pair]
        return float(max([entity.dxf.get("const_width", 0.0), *widths]))
    if isinstance(entity, Polyline) and entity.is_2d_polyline:
        names = ("start_width", "end_width")
        default = max(entity.dxf.get(f"default_{name}", 0.0) for name in names)
        return float(max([v.dxf.get(name, default) for v in entity.vertices for name in names], default=default))
    return 0.0


def _named(number: int) -> str:
    if number in NAMES:
        return NAMES[number]
    return "#{:02x}{:02x}{:02x}".format(*aci2rgb(number)) if 0 < number < BY_LAYER else "white"
