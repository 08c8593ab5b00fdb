"""Paths round contours that the torch can follow on metal alone: all of them on the sheet, none along its edge."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import Curve, lines_of
from kerfwise.encoder.nest import Contour

from .surroundings import CHORD_MM, Surroundings

_STEP_MM = 1.0


def off_the_sheet(contours: Sequence[Contour], paths: Mapping[int, Curve], around: Surroundings) -> dict[int, str]:
    """Where the paths of contours leave the sheet or run along its edge, as sentences, by contour number.

    The torch is lit on metal alone, but for the run-up of an edge start. So a part keeps more than half a kerf from the
    edge.
    """
    numbers = list(paths)
    lines = lines_of([paths[k] for k in numbers], CHORD_MM)
    astray = ~shapely.covers(around.sheet, lines) | shapely.dwithin(around.edges, lines, CHORD_MM)
    return {numbers[i]: _sentence(contours[numbers[i]], lines[i], around) for i in np.flatnonzero(astray).tolist()}


def _sentence(contour: Contour, line: shapely.LineString, around: Surroundings) -> str:
    points = shapely.get_coordinates(shapely.segmentize(shapely.difference(line, around.sheet), _STEP_MM))
    off_mm = np.asarray(shapely.distance(shapely.points(points), around.edges)) if len(points) else np.zeros(1)
    if off_mm.max() > CHORD_MM:
        (x, y), runs = points[int(off_mm.argmax())].tolist(), f"{off_mm.max():.3f} mm off the sheet"
    else:
        x, y = shapely.get_coordinates(shapely.shortest_line(line, around.edges))[0].tolist()
        runs = "along the edge of the sheet"
    if contour.kind == "mark":
        return f"{contour.id} runs {runs} at ({x:.3f}, {y:.3f}): move the mark or give a larger sheet"
    return (
        f"{contour.id}: the torch's path runs {runs} at ({x:.3f}, {y:.3f}): move the part or give a larger sheet, "
        "more than half a kerf of which lies beside each part"
    )
