"""DXF entities as curves: arcs stay arcs, splines and ellipses become arcs again, Z is ignored.

Only what can be cut is read. Whatever else is drawn is counted, so that its absence can be said aloud.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import shapely
from ezdxf.entities.arc import Arc
from ezdxf.entities.circle import Circle
from ezdxf.entities.dxfentity import DXFTagStorage
from ezdxf.entities.dxfgfx import DXFGraphic
from ezdxf.entities.ellipse import Ellipse
from ezdxf.entities.insert import Insert
from ezdxf.entities.line import Line
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.entities.polyline import Polyline
from ezdxf.entities.spline import Spline
from ezdxf.math import OCS, BSpline, ConstructionEllipse, Vec3
from ezdxf.path import Path, make_path
from ezdxf.xclip import XClip

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve

from .arcs import FLATTEN_MM, fitted
from .clipped import Clips
from .limits import LIMIT_MM, checked_curve
from .unclamped import Unclamped
from .unread import NO_LINES, Unread, layer_of

EVERYWHERE = 1e9
"""Half the side of a square that holds all that can be read, in any unit."""
EXTERNAL = 4
"""The bit in a block's flags that says that its lines are in another file."""
ROUND = 1e-6
"""An ellipse whose axes differ by less than this share is a circle."""


@dataclass(frozen=True, slots=True)
class Hidden:
    """The layers that are not shown, in lower case: what is inserted on one that is `off` has its own."""

    off: frozenset[str] = frozenset()
    frozen: frozenset[str] = frozenset()


NOTHING_CLIPPED: Clips = ()


def entities(
    drawn: Iterable[DXFGraphic],
    hidden: Hidden,
    unread: Unread,
    block_layer: str | None = None,
    clips: Clips = NOTHING_CLIPPED,
) -> Iterator[tuple[DXFGraphic, str, Clips]]:
    """Every entity to read with its layer, blocks taken apart (scaled, mirrored and nested ones too).

    An entity on layer 0 of a block lies on the layer of its insertion. Each comes with the areas that it is seen
    through, in units of the drawing, where blocks are clipped. Blocks must not contain themselves (`check_copies`).
    """
    for entity in drawn:
        layer = layer_of(entity)
        if block_layer is not None and layer == "0":
            layer = block_layer
        is_insert = isinstance(entity, Insert)
        if layer.lower() in hidden.frozen or (layer.lower() in hidden.off and not is_insert) or _invisible(entity):
            unread.hidden(entity, layer)
        elif entity.dxftype() in NO_LINES:
            unread.add(entity, layer)
        elif isinstance(entity, Insert):
            inside = (*clips, *_clip(entity))
            for insert in _inserted(entity, layer, unread):
                skip = partial(_skipped, unread=unread, layer=layer)
                inner = insert.virtual_entities(skipped_entity_callback=skip)
                yield from entities(inner, hidden, unread, layer, inside)
        else:
            yield entity, layer, clips


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
    for attribute in insert.attribs:
        if not _invisible(attribute):
            own_layer = layer_of(attribute)
            unread.add(attribute, layer if own_layer == "0" else own_layer)
    block = insert.block()
    if block is None or block.block is None:
        unread.types["INSERT of a block that the file does not hold", layer] += insert.mcount
        return ()
    if block.block.dxf.get("flags", 0) & EXTERNAL:
        unread.types["INSERT of another file (XREF)", layer] += insert.mcount
        return ()
    if not insert.dxf.xscale or not insert.dxf.yscale:
        unread.types["INSERT of a block at scale 0", layer] += insert.mcount
        return ()
    for entity in block:
        if isinstance(entity, DXFTagStorage):  # the library copies all but these, and says nothing of them
            unread.types[entity.dxftype(), layer] += insert.mcount
    if not insert.dxf.zscale:
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
            return _polyline(OCS(), [(*v.dxf.location, 0.0) for v in entity.vertices], entity.is_closed, 1.0, scale)
        case Arc() | Circle() | LWPolyline():
            pass
        case Polyline() if entity.is_2d_polyline:
            pass
        case _:
            return None
    tilt = Vec3(entity.dxf.extrusion).normalize().z
    if abs(abs(tilt) - 1) > ROUND:  # drawn on a tilted plane, seen from above
        path = make_path(entity)
        return _flattened(path, path.control_vertices(), scale)
    match entity:
        case Arc():
            a0, a1 = math.radians(entity.dxf.start_angle), math.radians(entity.dxf.end_angle)
            return _arc(entity, a0, (a1 - a0) % math.tau or math.tau, tilt, scale)
        case Circle():
            return _arc(entity, 0.0, math.tau, tilt, scale)
        case LWPolyline():
            points = [(x, y, 0.0, b) for x, y, b in entity.get_points("xyb")]
            return _polyline(entity.ocs(), points, entity.closed, tilt, scale)
        case _:  # the control points (16) of a smoothed POLYLINE are no part of the line
            vertices = [v.dxf for v in entity.vertices if not v.dxf.get("flags", 0) & 16]
            points = [(*v.location, float(v.get("bulge", 0.0))) for v in vertices]
            return _polyline(entity.ocs(), points, entity.is_closed, tilt, scale)


def _arc(circle: Circle, start_rad: float, sweep_rad: float, tilt: float, scale: float) -> Curve:
    ocs, centre, radius = circle.ocs(), Vec3(circle.dxf.center), circle.dxf.radius
    angles = (start_rad, start_rad + sweep_rad / 2, start_rad + sweep_rad)
    return _bent([ocs.to_wcs(centre + Vec3.from_angle(a, radius)) for a in angles], sweep_rad, tilt, scale)


def _bent(rim: Sequence[Vec3], sweep_rad: float, tilt: float, scale: float) -> Curve:
    """An arc by its start, middle and end, halved if over a half-circle; a full turn is a closed curve."""
    shares = 1 if sweep_rad <= math.pi else 2
    bulge = math.copysign(math.tan(sweep_rad / (4 * shares)), tilt)
    rows = [(p.x, p.y, bulge) for p in (rim[0], rim[1], rim[2])]
    closed = sweep_rad >= math.tau - 1e-9
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
    if abs(ellipse.ratio - 1) < ROUND and abs(abs(tilt) - 1) < ROUND:
        params = [ellipse.start_param + sweep * f for f in (0.0, 0.5, 1.0)]
        return _bent(list(ellipse.vertices(params)), sweep, tilt, scale)
    return _flattened(ellipse, [ellipse.center, ellipse.center + ellipse.major_axis], scale)


def _flattened(
    drawn: BSpline | Unclamped | ConstructionEllipse | Path, control: Iterable[Vec3], scale: float
) -> Curve | None:
    """Fitted arcs through a curve that DXF draws and no machine can; `control` points bound its extent."""
    for p in control:  # flattening a curve of astronomic size would never end
        if not max(abs(p.x), abs(p.y), abs(p.z)) * scale <= LIMIT_MM:
            raise InputError(
                f"({p.x:g}, {p.y:g}) lies more than a kilometre from the origin: if the units are wrong, "
                "pass --units (in Python: units=)"
            )
    return fitted(np.array([(p.x, p.y) for p in drawn.flattening(FLATTEN_MM / scale, 8)]) * scale)
