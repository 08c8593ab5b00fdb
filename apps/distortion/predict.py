"""How far each part of a plan or a program will be off: from its file to a table, JSON and a picture."""

from __future__ import annotations

import html
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.jobs.display import Picture
from kerfwise.jobs.heat_path import path_of_made, path_of_program
from kerfwise.jobs.inputs import Inputs, Tell, silent
from kerfwise.jobs.programs import OldJob
from kerfwise.models.physics.heat import TimedPath
from kerfwise.models.physics.heat.simulate import expect_short
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.plant_sections import Heat

from .compensation import Compensated, Kind, compensated, size_lines
from .cutting import Cutting, Followed, cell_mm, cut_sheet, cutting_of
from .elasticity import metal_of
from .part_errors import PartError, errors_of
from .tolerances import Beyond, beyond, kept_or_not, tolerances_of

if TYPE_CHECKING:
    from kerfwise.postproc.check.reader.read_program import Trusted

CELLS = 7200
"""Cells of a sheet where nobody says how wide they are: 25 mm on 3000 x 1500."""
MOST_CELLS = 60_000
FINEST_MM = 1.0
_SHOWN = 15
"""Parts that the table lists."""


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Distortion:
    """Errors of the parts of a plan or a program, in the nest's order; `how` it was simulated, on which `path`.

    `tolerances` are what parts may be off, mm, by part; those without one are left out.
    """

    nest: Nest
    path: TimedPath
    heat: Heat
    how: Cutting
    parts: tuple[PartError, ...]
    tolerances: Mapping[str, float] = field(default_factory=dict)

    @property
    def beyond(self) -> tuple[Beyond, ...]:
        """The parts that will be off by more than they may."""
        return beyond(self.parts, self.tolerances)

    @property
    def max_mm(self) -> float:
        """The worst error of any part, mm."""
        return max((p.max_mm for p in self.parts if p.max_mm is not None), default=0.0)

    @property
    def mean_mm(self) -> float:
        """The mean over the parts of what each is off at its worst place, mm."""
        known = [p.max_mm for p in self.parts if p.max_mm is not None]
        return sum(known) / len(known) if known else 0.0

    def compensated(self, kind: Kind = "size") -> Compensated:
        """The nest with its parts drawn so that, cut by this plan, they come out as wanted: in size, or in shape too.

        Raises InputError if a part would be changed by more than any cut does, or there is no room for what is larger.
        """
        return compensated(self.nest, self.parts, kind, self.how.kerf_mm)

    def as_json(self) -> dict[str, Any]:
        """What `kerfwise distort --json` prints."""
        return {
            "grid_mm": round(self.how.grid_mm, 4),
            "parts": [
                {
                    "part": p.part,
                    "max_mm": None if p.max_mm is None else round(p.max_mm, 4),
                    "rms_mm": None if p.rms_mm is None else round(p.rms_mm, 4),
                    "at": None if p.at is None else [round(c, 2) for c in p.at],
                }
                | self._tolerance(p)
                for p in self.parts
            ],
        }

    def _tolerance(self, error: PartError) -> dict[str, Any]:
        """What is said of a part that has a tolerance."""
        if (most := self.tolerances.get(error.part)) is None:
            return {}
        return {"tolerance_mm": most, "kept": None if error.max_mm is None else error.max_mm <= most}

    def line(self) -> str:
        """All in one line, as `kerfwise solve` prints it."""
        worst = max(self.parts, key=lambda p: p.max_mm or 0.0, default=None)
        named = f" ({escape_text(worst.part)})" if worst is not None and worst.max_mm else ""
        verdict = kept_or_not(self.beyond, len(self.tolerances))
        return f"parts up to {self.max_mm:.2f} mm off when cold{named}, {self.mean_mm:.2f} mm on average" + (
            f"; {verdict}" if verdict else ""
        )

    def picture(self) -> Picture:
        """An SVG of the sheet with the shapes of its parts drawn exaggerated."""
        return Picture(draw_parts(self.nest, self.parts, self._title), "svg")

    def animation(self) -> Picture:
        """An HTML page that shows how the sheet moves while it is cut, exaggerated. It is simulated once more."""
        return Picture(animate(self.nest, self.path, self.heat, self.how, self._title), "html")

    @property
    def _title(self) -> str:
        name = f"{Path(self.nest.file).name}: " if self.nest.file else ""
        return f"{name}parts up to {self.max_mm:.2f} mm off when cold, {self.mean_mm:.2f} mm on average"

    def __repr__(self) -> str:
        return f"<Distortion: worst {self.max_mm:.2f} mm, mean of parts {self.mean_mm:.2f} mm>"

    def __str__(self) -> str:
        metal = "metal yields beside the cut" if self.how.yields else "elastic"
        lines = [
            f"{'model':10} plane stress, {metal}, grid {self.how.grid_mm:.3g} mm",
            f"{'worst':10} {self.max_mm:.2f} mm",
            f"{'mean':10} {self.mean_mm:.2f} mm, of the worst place of each part",
        ]
        lines += size_lines(self.nest, self.parts)
        known = sorted((p for p in self.parts if p.max_mm is not None), key=lambda p: (-(p.max_mm or 0.0), p.part))
        width = max([4, *(len(p.part) for p in known[:_SHOWN])])
        lines += ["", f"{'part':{width}} {'worst, mm':>10} {'mean, mm':>9}   where"]
        for p in known[:_SHOWN]:
            x, y = p.at or (0.0, 0.0)
            lines.append(f"{p.part:{width}} {p.max_mm:10.2f} {p.rms_mm:9.2f}   ({x:.0f}, {y:.0f})")
        if len(known) > _SHOWN:
            lines.append(f"… and {len(known) - _SHOWN} straighter parts")
        if uncut := [p.part for p in self.parts if p.max_mm is None]:
            lines.append(f"not cut, and so not known: {', '.join(uncut[:_SHOWN])}")
        if verdict := kept_or_not(self.beyond, len(self.tolerances)):
            lines.append(verdict)
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return self.picture().html()


def distort_made(
    inputs: Inputs,
    plan: Plan | str | Path,
    tell: Tell = silent,
    grid_mm: float | None = None,
    yields: bool = True,
    trusted: Trusted | None = None,
) -> Distortion:
    """How far the parts of a plan, or of the plan or NC program in a file, will be off.

    Parameters
    ----------
    inputs
        Nest and profile; heat, material, thickness and kerf are the profile's.
    plan
        A plan, or the path of a plan or a program.
    tell
        Told what the user should know.
    grid_mm
        Width of the mesh's cells; of None as many as make `CELLS` of the sheet.
    yields
        Whether the metal beside the cut yields; else all is elastic.
    trusted
        What a program leaves to the machine's material.

    Raises InputError if the file cannot be read or is one of another nest, the plan states no times, the grid does not
    fit the sheet, or nothing is known of the material's strength.
    """
    return distort_path(inputs, _path_of(inputs, plan, tell, trusted), grid_mm, yields)


def distort_old(job: OldJob, grid_mm: float | None = None, yields: bool = True) -> Distortion:
    """How far the parts of an old program will be off, on the nest that is told from its burns."""
    return distort_path(job.given, path_of_program(job.program, job.name), grid_mm, yields)


def distort_path(inputs: Inputs, path: TimedPath, grid_mm: float | None = None, yields: bool = True) -> Distortion:
    """The same of a timed path."""
    expect_short(path)
    nest, profile = inputs.nest, inputs.profile
    how = _how(inputs, grid_mm, yields)
    tolerances = tolerances_of(nest, profile)
    errors = errors_of(nest, cut_sheet(nest, path, profile.heat, how))
    return Distortion(nest, path, profile.heat, how, errors, tolerances)


def movement_of(inputs: Inputs, plan: Plan, frames: int, points: int) -> dict[str, Any]:
    """How the sheet moves while a plan is cut, as `movement` tells it; InputError as from `distort_made`."""
    path = _path_of(inputs, plan, silent, None)
    return movement(inputs.nest, path, inputs.profile.heat, _how(inputs, None, True), frames, points)


def _path_of(inputs: Inputs, plan: Plan | str | Path, tell: Tell, trusted: Trusted | None) -> TimedPath:
    metal_of(inputs.profile.heat.material)
    return path_of_made(plan, inputs, tell, trusted, along_contours=True)


def _how(inputs: Inputs, grid_mm: float | None, yields: bool) -> Cutting:
    return cutting_of(inputs.profile.material, _grid(inputs.nest, grid_mm), yields)


def _grid(nest: Nest, grid_mm: float | None) -> float:
    """The width of a cell, mm, within bounds."""
    x0, y0, x1, y1 = nest.sheet.bounds
    area = (x1 - x0) * (y1 - y0)
    if grid_mm is None:
        return max(FINEST_MM, cell_mm(nest, CELLS))
    if area / grid_mm**2 > MOST_CELLS:
        raise InputError(
            f"--grid: {grid_mm:g} mm makes {area / grid_mm**2:.0f} cells of this sheet, and {MOST_CELLS} is the most: "
            f"give {1.01 * math.sqrt(area / MOST_CELLS):.2g} mm or more"
        )
    if grid_mm > min(x1 - x0, y1 - y0) / 4:
        raise InputError(
            f"--grid: cells of {grid_mm:g} mm are too wide for a sheet of {x1 - x0:g} x {y1 - y0:g} mm: give "
            f"{min(x1 - x0, y1 - y0) / 4:.3g} mm or less"
        )
    return grid_mm


# How the sheet moves while it is cut, many times as far as it does: a page that plays by itself, no network needed.

FRAMES = 150
POINTS = 64
"""Points along each contour and along the sheet's edge, at the most."""
LEAST_STEP_MM = 4.0


@dataclass(frozen=True, eq=False, slots=True)
class _Line:
    """A closed or open line: its points (k, 2), mm, and the number of the part that it bounds, -1 for the sheet."""

    name: str
    kind: str
    xy: Floats
    part: int


def animate(nest: Nest, path: TimedPath, heat: Heat, how: Cutting, title: str) -> bytes:
    """An HTML page: the sheet, its parts and the torch along the program's time, then the parts as they will be.

    Where metal is that has moved is drawn `exaggeration` times as far off. What is cut free stays where it was. Raises
    InputError if nothing is known of the metal's strength.
    """
    page = (resources.files(__package__) / "animation.html").read_text(encoding="utf-8")
    text = json.dumps(movement(nest, path, heat, how), separators=(",", ":")).replace("<", "\\u003c")
    return page.replace("{{title}}", html.escape(title)).replace("{{data}}", text).encode("utf-8")


def movement(
    nest: Nest, path: TimedPath, heat: Heat, how: Cutting, frames: int = FRAMES, points: int = POINTS
) -> dict[str, Any]:
    """Where metal is at each of some `frames`, as JSON can hold it; each line has so many `points` at the most.

    `lines` are the sheet's edge and the contours of parts: `xy` as drawn, mm, `moved` in each frame and how far `cold`
    ones are off, both in µm, `off` what the part is off at its worst place, mm. Raises InputError if nothing is known
    of the metal's strength.
    """
    lines = list(_lines(nest, points))
    xy = np.concatenate([line.xy for line in lines])
    part = np.concatenate([np.full(len(line.xy), line.part) for line in lines])
    at_s = _frames(path, frames)
    follow = Followed(xy, part, at_s, np.zeros((len(at_s), len(xy), 2)))
    cut = cut_sheet(nest, path, heat, how, follow)
    errors = errors_of(nest, cut)
    moved = _without_drift(follow)
    x0, y0, x1, y1 = nest.sheet.bounds
    long_mm = max(x1 - x0, y1 - y0)
    most_mm = float(np.hypot(moved[..., 0], moved[..., 1]).max(initial=0.0))
    worst_mm = max((e.max_mm or 0.0 for e in errors), default=0.0)
    ends = np.cumsum([0, *(len(line.xy) for line in lines)])
    cut_s = {nest.contours[k].id: at_s for k, at_s in zip(cut.contour.tolist(), cut.at_s.tolist(), strict=True)}
    cut_s |= {burn.contour: float(burn.at_s[-1]) for burn in path.burns}
    by_part = {error.part: error for error in errors}
    return {
        "sheet": [x0, y0, x1, y1],
        "at_s": np.round(at_s, 1).tolist(),
        "times": exaggeration(0.4 * most_mm, long_mm),
        "times_cold": exaggeration(worst_mm, long_mm),
        "torch": np.round(_torch(path, at_s), 1).tolist(),
        "lines": [
            {
                "name": line.name,
                "kind": line.kind,
                "xy": np.round(line.xy, 1).ravel().tolist(),
                "moved": _um(moved[:, a:b].reshape(len(at_s), -1)),
                "cut_s": cut_s.get(line.name),
                "cold": _cold(nest, line, by_part),
                "off": by_part[nest.contour(line.name).part].max_mm if line.kind == "outer" else None,
            }
            for line, a, b in zip(lines, ends[:-1].tolist(), ends[1:].tolist(), strict=True)
        ],
    }


def _lines(nest: Nest, points: int) -> list[_Line]:
    rings = [nest.sheet.polygon.exterior, *nest.sheet.polygon.interiors]
    found = [_Line("", "sheet", _points(ring, points), -1) for ring in rings]
    for contour, part in zip(nest.contours, nest.owners, strict=True):
        if contour.shapes_part:
            found.append(_Line(contour.id, contour.kind, _points(contour.line, points), part))
    return found


def _points(line: shapely.LineString, count: int) -> Floats:
    """The corners of a line, and points between them."""
    points: Floats = shapely.get_coordinates(shapely.segmentize(line, max(line.length / count, LEAST_STEP_MM)))
    return points


def _frames(path: TimedPath, count: int) -> Floats:
    """Times of frames: the torch goes on evenly from one to the next, and travels in no time."""
    starts = np.array([burn.at_s[0] for burn in path.of_first])
    on_s = np.array([burn.seconds for burn in path.of_first])
    total = np.concatenate([[0.0], np.cumsum(on_s)])
    at = np.linspace(0.0, total[-1], count) if len(on_s) else np.zeros(1)
    k = np.clip(np.searchsorted(total, at, side="right") - 1, 0, max(len(on_s) - 1, 0))
    found: Floats = starts[k] + at - total[k] if len(on_s) else at
    return found


def _torch(path: TimedPath, at_s: Floats) -> Floats:
    """Where the first torch is at each of these times (f, 2)."""
    if not path.burns:
        return np.zeros((len(at_s), 2))
    when = np.concatenate([burn.at_s for burn in path.of_first])
    xy = np.concatenate([burn.xy for burn in path.of_first])
    return np.column_stack([np.interp(at_s, when, xy[:, c]) for c in (0, 1)])


def _without_drift(follow: Followed) -> Floats:
    """The movements (f, k, 2) without what the sheet's edge has moved on average: where it lies is nobody's concern."""
    edge: Ints = np.flatnonzero(follow.part < 0)
    found: Floats = follow.moved - follow.moved[:, edge].mean(axis=1, keepdims=True)
    return found


def _cold(nest: Nest, line: _Line, by_part: Mapping[str, PartError]) -> list[int] | None:
    """How far the points of a contour are off when all is cold, µm; None for the sheet and for what was not cut."""
    if line.kind == "sheet":
        return None
    contour = nest.contour(line.name)
    off = off_along(contour, nest.index[line.name], line.xy, by_part[contour.part])
    return None if off is None else _um(off.ravel())


def _um(mm: Floats) -> Any:
    return np.round(mm * 1000).astype(np.int64).tolist()


_WIDTH = 1200.0
_DRAWN = 0.025
"""The worst place is drawn about so far off, as a share of the sheet's longer side."""
_COLOURS = ("#1b7837", "#7fbf7b", "#e0a100", "#d95f0e", "#b10026")


def exaggeration(worst_mm: float, long_side_mm: float) -> float:
    """How many times as large errors are drawn: 1, 2 or 5 times a power of ten.

    Examples
    --------
    >>> exaggeration(1.3, 3000.0), exaggeration(0.0, 3000.0)
    (50.0, 1.0)
    """
    if worst_mm <= 0:
        return 1.0
    wanted = max(1.0, _DRAWN * long_side_mm / worst_mm)
    power: float = 10.0 ** math.floor(math.log10(wanted))
    return next(step * power for step in (5.0, 2.0, 1.0) if step * power <= wanted)


def draw_parts(nest: Nest, parts: Sequence[PartError], title: str) -> bytes:
    """Every part as it is drawn (grey) and as it will be, coloured by its worst error, which stands beside it."""
    x0, y0, x1, y1 = nest.sheet.bounds
    scale = _WIDTH / max(x1 - x0, 1e-9)
    height = (y1 - y0) * scale
    worst = max((p.max_mm or 0.0 for p in parts), default=0.0)
    times = exaggeration(worst, max(x1 - x0, y1 - y0))

    def path(points: Floats) -> str:
        at = np.column_stack([(points[:, 0] - x0) * scale, (y1 - points[:, 1]) * scale])
        return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in at)

    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-20 -64 {_WIDTH + 40:.0f} {height + 110:.0f}" '
        'font-family="sans-serif" font-size="14">',
        f'<rect x="-20" y="-64" width="{_WIDTH + 40:.0f}" height="{height + 110:.0f}" fill="#ffffff"/>',
        f'<text x="0" y="-40" font-size="16">{html.escape(title)}</text>',
        f'<text x="0" y="-18" fill="#555555">shapes are drawn {times:g} times as far off as they are; '
        "grey: as drawn in the nest</text>",
    ]
    rings = [nest.sheet.polygon.exterior, *nest.sheet.polygon.interiors]
    for ring in rings:
        lines.append(f'<path d="{path(shapely.get_coordinates(ring))}Z" fill="none" stroke="#222222"/>')
    labels = []
    for error in parts:
        part = nest.part_of[error.part]
        contours = [contour for contour in part if contour.shapes_part]
        for contour in contours:
            lines.append(f'<path d="{path(shapely.get_coordinates(contour.line))}" fill="none" stroke="#b0b0b0"/>')
        if error.max_mm is None or error.at is None:
            continue
        colour = _COLOURS[min(int(error.max_mm / max(worst, 1e-12) * len(_COLOURS)), len(_COLOURS) - 1)]
        for contour in contours:
            points = shapely.get_coordinates(shapely.segmentize(contour.line, max(contour.line.length / 120, 1e-6)))
            off = off_along(contour, nest.index[contour.id], points, error)
            if off is not None:
                bent = path(points + times * off)
                lines.append(f'<path d="{bent}" fill="none" stroke="{colour}" stroke-width="1.8"/>')
        x, y = part.polygon.representative_point().coords[0]
        label = html.escape(f"{error.part} {error.max_mm:.2f}")
        labels.append(
            f'<text x="{(x - x0) * scale:.1f}" y="{(y1 - y) * scale:.1f}" text-anchor="middle" font-size="11" '
            f'fill="#111111">{label}</text>'
        )
        ax, ay = error.at
        labels.append(f'<circle cx="{(ax - x0) * scale:.1f}" cy="{(y1 - ay) * scale:.1f}" r="3" fill="{colour}"/>')
    lines += labels
    for k, colour in enumerate(_COLOURS):
        at = k * 150
        label = f"{worst * k / len(_COLOURS):.2f} to {worst * (k + 1) / len(_COLOURS):.2f} mm"
        lines.append(f'<rect x="{at}" y="{height + 16:.1f}" width="14" height="14" fill="{colour}"/>')
        lines.append(f'<text x="{at + 20}" y="{height + 28:.1f}">{label}</text>')
    lines.append("</svg>\n")
    return "\n".join(lines).encode("utf-8")


def off_along(contour: Contour, number: int, points: Floats, error: PartError) -> Floats | None:
    """How far off points (k, 2) along a contour are, mm (k, 2): straight between those followed; None without any."""
    mine = error.contour == number
    if not mine.any():
        return None
    line = contour.line
    along = shapely.line_locate_point(line, shapely.points(error.xy[mine]))
    order = np.argsort(along)
    along, off = along[order], error.off[mine][order]
    at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    period = line.length if contour.curve.closed else None
    return np.column_stack([np.interp(at, along, off[:, c], period=period) for c in (0, 1)])
