"""How hot a plan or a program makes the sheet, where, and for how long; as a picture."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.display import Picture, data_frame
from kerfwise.jobs.heat_path import path_of_made, path_of_program
from kerfwise.jobs.inputs import Inputs, Tell, silent
from kerfwise.jobs.programs import OldJob
from kerfwise.models.physics.heat import HeatResult, PartHeat, TimedPath, simulate
from kerfwise.models.physics.heat.physical import point_steps
from kerfwise.models.physics.heat.timed_path import (
    MOST_POINTS,
    SCRAP,
    Grid,
    make_grid,
)
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check.reader.read_program import Trusted
from kerfwise.postproc.report.legend import duration
from kerfwise.rules.profile.plant_sections import Heat, HeatModel

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes


MODELS: tuple[HeatModel, ...] = ("physical", "logical")
_SHOWN = 15
"""Parts that the table lists."""
_POINT_STEPS_PER_SECOND, _LONG_S = 5e8, 60.0
"""What one core of a usual machine simulates at the least, and how long goes without saying."""


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Simulation:
    """The heat that a plan or a program leaves in the sheet.

    `found` holds the maps of the highest temperature, °C, and of the seconds above the limit, over `found.grid`.
    `frames` are PNG pictures of the sheet by file name, evenly over the program, where they were asked for.
    """

    nest: Nest
    heat: Heat
    found: HeatResult
    frames: Mapping[str, bytes] = field(default_factory=dict)

    @property
    def overheats(self) -> int:
        """Points of the grid that were hotter than the limit, outside the kerf's band."""
        return self.found.overheats

    @property
    def peak_c(self) -> float:
        """The highest temperature outside the kerf's band, °C."""
        return self.found.peak_c

    @property
    def parts(self) -> tuple[PartHeat, ...]:
        """Part by part: peak, overheats, and the longest that a point was too hot."""
        return self.found.parts

    def picture(self) -> Picture:
        """A PNG of the highest temperature of every point."""

        return Picture(peak_map(self.nest, self.found, self.heat.ambient_c), "png")

    def to_frame(self) -> pandas.DataFrame:
        """A row for each part: part, peak_c, overheats, above_s.

        Raises InputError if pandas is not installed.
        """
        return data_frame(self.as_json()["parts"])

    def as_json(self) -> dict[str, Any]:
        """What was found, as `kerfwise heat --json` prints it."""
        found, error = self.found, self.found.energy_error
        return {
            "model": found.model,
            "overheats": found.overheats,
            "peak_c": round(found.peak_c, 2),
            "grid_mm": found.grid.step_mm,
            "energy_error": None if error is None else round(error, 8),
            "limit_c": found.limit_c,
            "above_s": round(found.above_s, 2),
            "parts": [
                {
                    "part": p.part,
                    "peak_c": None if p.peak_c is None else round(p.peak_c, 2),
                    "overheats": p.overheats,
                    "above_s": round(p.above_s, 2),
                }
                for p in found.parts
            ],
        }

    def __repr__(self) -> str:
        return f"<Simulation: peak {self.peak_c:.1f} °C, {self.overheats} overheats>"

    def __str__(self) -> str:
        found, grid_mm = self.found, self.found.grid.step_mm
        lines = [
            f"{'model':10} {found.model}, grid {grid_mm:g} mm",
            f"{'peak':10} {found.peak_c:.1f} °C outside the kerf's band, limit {found.limit_c:g} °C",
            f"{'overheats':10} {found.overheats} points, {found.overheats * grid_mm**2 / 100:.1f} cm²",
            f"{'too hot':10} {found.above_s:.0f} s at the longest",
        ]
        if found.energy_error is not None:
            lines.append(f"{'energy':10} {found.energy_error:.2e} of what was put in is not accounted for")
        parts = sorted(found.parts, key=lambda p: (-p.overheats, -(p.peak_c or 0.0), p.part))
        width = max([4, *(len(p.part) for p in parts[:_SHOWN])])
        lines += ["", f"{'part':{width}} {'peak °C':>9} {'overheats':>10} {'too hot, s':>11}"]
        lines += [f"{p.part:{width}} {_told(p):>9} {p.overheats:10d} {p.above_s:11.0f}" for p in parts[:_SHOWN]]
        if len(parts) > _SHOWN:
            lines.append(f"… and {len(parts) - _SHOWN} cooler parts")
        if unseen := sum(p.peak_c is None for p in parts):
            lines.append(
                f"no point of {unseen} narrow part{'s' if unseen > 1 else ''} (-) lies outside the kerf's band"
            )
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return self.picture().html()


def simulate_made(
    inputs: Inputs,
    plan: Plan | str | Path,
    model: HeatModel | None = None,
    tell: Tell = silent,
    frames: int = 0,
    trusted: Trusted | None = None,
) -> Simulation:
    """Simulate a plan, or the plan or NC program in a file, by the profile's section `heat`.

    So many `frames` are drawn, evenly over the program. What a program leaves to the machine's material is
    refused, unless that is `trusted`.

    Raises InputError if the file cannot be read or is one of another nest, the plan states no times, there is no such
    model, or the grid is too fine for the sheet or too coarse for its parts.
    """
    _expect_model(model)
    path = path_of_made(plan, inputs, tell, trusted)
    return _simulated(inputs, path, model, tell, frames)


def simulate_old(job: OldJob, model: HeatModel | None = None, tell: Tell = silent, frames: int = 0) -> Simulation:
    """Simulate an old program, on the nest that is told from its burns.

    Raises InputError if they make no nest; else as `simulate_made` does.
    """
    _expect_model(model)
    return _simulated(job.given, path_of_program(job.program, job.name), model, tell, frames)


def _expect_model(model: HeatModel | None) -> None:
    if model is not None and model not in MODELS:
        raise InputError(unknown("model of heat", str(model), MODELS))


def _simulated(inputs: Inputs, path: TimedPath, model: HeatModel | None, tell: Tell, frames: int) -> Simulation:
    nest, profile = inputs.nest, inputs.profile
    heat = replace(profile.heat, model=model) if model else profile.heat
    _warn_if_long(nest, path, heat, tell)
    thickness_mm = profile.material.thickness_mm
    if not frames or path.end_s <= 0:
        return Simulation(nest, heat, simulate(nest, path, heat, thickness_mm))

    picture, shown = HeatPicture(nest, make_grid(nest, heat.grid_mm), heat.ambient_c, heat.limit_c), dict[str, bytes]()

    def look(now_s: float, field: Any) -> None:
        if len(shown) < frames:
            name = f"frame_{len(shown) + 1:03d}.png"
            shown[name] = picture.png(field, f"{now_s / 60:.1f} min of {path.end_s / 60:.1f}")

    return Simulation(nest, heat, simulate(nest, path, heat, thickness_mm, (path.end_s / frames, look)), shown)


def _warn_if_long(nest: Nest, path: TimedPath, heat: Heat, tell: Tell) -> None:
    """Tell beforehand what a fine grid will cost: the work goes with the fourth power of its fineness."""
    area_mm2 = nest.sheet.polygon.area
    longest_s = point_steps(area_mm2, path.end_s, heat) / _POINT_STEPS_PER_SECOND
    refused = area_mm2 / heat.grid_mm**2 > MOST_POINTS
    if heat.model == "physical" and heat.absorbed_power_w and longest_s > _LONG_S and not refused:
        wider_mm = heat.grid_mm * (longest_s / _LONG_S) ** 0.25
        took = f"a grid of {heat.grid_mm:g} mm takes up to about {duration(longest_s)} here"
        tell(f"{took}, one of {wider_mm:.2g} mm a minute (heat.grid); Ctrl-C ends it")


def _told(part: PartHeat) -> str:
    return "-" if part.peak_c is None else f"{part.peak_c:.1f}"


# Temperatures of a sheet as a picture: the colour of every point, the contours, what is too hot, and a colour bar.

LONG_SIDE_INCHES = 12.0
DPI = 120
OVER = 1.4
"""The colours reach so many times as far above the air as the limit does."""
_HOT, _BAND, _SCRAP = "#2fb4ff", "#8f959c", "#d0d4d8"


@dataclass(frozen=True, eq=False, slots=True)
class HeatPicture:
    """Draws maps of one sheet, all in the same colours."""

    nest: Nest
    grid: Grid
    ambient_c: float
    limit_c: float

    def png(self, field: NDArray[np.float32], title: str, counted: Bools | None = None) -> bytes:
        """A PNG of temperatures (nx, ny), °C, with a line around what is hotter than the limit.

        Where `counted` points are given, the others are grey, and those of them that are too hot are blue.
        """
        # Loading matplotlib takes longer than most verbs: only those who want a picture pay for it.
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        nx, ny = self.grid.shape
        scale = LONG_SIDE_INCHES / max(nx, ny)
        figure = Figure(figsize=(max(nx * scale, 6.0) + 1.4, max(ny * scale, 2.0) + 1.2), dpi=DPI, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        shown = np.where(self.grid.metal if counted is None else counted, field, np.nan)
        hottest_c = self.ambient_c + OVER * (self.limit_c - self.ambient_c)
        image = axes.imshow(
            shown.T, origin="lower", extent=self._extent(), cmap="inferno", vmin=self.ambient_c, vmax=hottest_c,
            interpolation="nearest",
        )  # fmt: skip
        label = "blue line: limit"
        if counted is not None:
            self._fill(axes, self.grid.metal & ~counted, _BAND)
            self._fill(axes, self.grid.metal & (self.grid.part == SCRAP), _SCRAP)
            self._fill(axes, counted & (field > self.limit_c), _HOT)
            label = "blue: hotter than the limit · grey: the kerf's band and (lighter) scrap, which are not counted"
        self._draw_limit(axes, shown)
        self._draw_contours(axes)
        axes.set_title(f"{title}\n{label}", fontsize=10, loc="left")
        axes.tick_params(labelsize=8)
        axes.set_xlabel("x, mm", fontsize=9)
        axes.set_ylabel("y, mm", fontsize=9)
        bar = figure.colorbar(image, ax=axes, extend="max", fraction=0.04, pad=0.01)
        bar.ax.axhline(self.limit_c, color=_HOT, linewidth=3)
        bar.set_label(f"°C (blue: the limit, {self.limit_c:g} °C)", fontsize=9)
        bar.ax.tick_params(labelsize=8)
        file = io.BytesIO()
        figure.savefig(file, format="png", metadata={"Software": None})
        return file.getvalue()

    def _extent(self) -> tuple[float, float, float, float]:
        """Left, right, bottom and top of the squares around the points, mm."""
        grid, (nx, ny) = self.grid, self.grid.shape
        x0, y0 = grid.x0_mm - grid.step_mm / 2, grid.y0_mm - grid.step_mm / 2
        return x0, x0 + nx * grid.step_mm, y0, y0 + ny * grid.step_mm

    def _fill(self, axes: Axes, points: Bools, colour: str) -> None:
        from matplotlib.colors import ListedColormap

        ones = np.where(points, 1.0, np.nan).T
        axes.imshow(ones, origin="lower", extent=self._extent(), cmap=ListedColormap([colour]), interpolation="nearest")

    def _draw_limit(self, axes: Axes, shown: NDArray[np.float32]) -> None:
        if min(self.grid.shape) < 2 or not (shown > self.limit_c).any():
            return
        x, y = (
            first_mm + self.grid.step_mm * np.arange(count)
            for first_mm, count in zip((self.grid.x0_mm, self.grid.y0_mm), self.grid.shape, strict=True)
        )
        axes.contour(x, y, np.ma.masked_invalid(shown.T), levels=[self.limit_c], colors=[_HOT], linewidths=1.2)

    def _draw_contours(self, axes: Axes) -> None:
        """White lines with a dark rim, which can be seen on every colour."""
        from matplotlib.collections import LineCollection

        lines = [np.asarray(contour.line.coords) for contour in self.nest.contours if contour.kind != "mark"]
        x, y = self.nest.sheet.polygon.exterior.xy
        lines.append(np.column_stack([x, y]))
        for colour, width in (("black", 1.9), ("white", 0.8)):
            axes.add_collection(LineCollection(lines, colors=colour, linewidths=width))


def peak_map(nest: Nest, result: HeatResult, ambient_c: float) -> bytes:
    """The highest temperature of every point that counts; those too hot in blue."""
    picture = HeatPicture(nest, result.grid, ambient_c, result.limit_c)
    grid_mm, found = result.grid.step_mm, f"{result.overheats} overheats, peak {result.peak_c:.1f} °C"
    name = f"{Path(nest.file).name}: " if nest.file else ""
    title = f"{name}highest temperatures, {result.model} model, grid {grid_mm:g} mm: {found}"
    return picture.png(result.run.peak_c, title, result.counted)
