"""How hot a plan or a program makes the sheet, where, and for how long."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.models.physics.heat import HeatResult, PartHeat, TimedPath, simulate
from kerfwise.models.physics.heat.bounds import expect_short
from kerfwise.models.physics.heat.grid import MOST_POINTS, make_grid
from kerfwise.models.physics.heat.physical import point_steps
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.reader import read_plan
from kerfwise.postproc.check.reader.old import Trusted
from kerfwise.postproc.clock.heat_path import path_of_plan, path_of_program
from kerfwise.postproc.report.legend import duration
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.profile.heat_section import Heat, HeatModel

from .given import Given, Tell, differences, is_plan_file, read_program_of, silent
from .old_program import OldJob
from .one_torch import expect_one_torch
from .picture import Picture
from .table import data_frame

if TYPE_CHECKING:
    import pandas

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
        from kerfwise.postproc.report.heat_map import peak_map

        return Picture(peak_map(self.nest, self.found, self.heat.ambient_c), "png")

    def to_frame(self) -> pandas.DataFrame:
        """A row for each part: part, peak_c, overheats, above_s.

        Raises
        ------
        InputError
            If pandas is not installed.
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
    given: Given,
    made: Plan | str | Path,
    model: HeatModel | None = None,
    tell: Tell = silent,
    frames: int = 0,
    trusted: Trusted | None = None,
) -> Simulation:
    """Simulate a plan, or the plan or NC program in a file, by the profile's section `heat`.

    So many `frames` are drawn, evenly over the program. What a program leaves to the machine's material is
    refused, unless that is `trusted`.

    Raises
    ------
    InputError
        If the file cannot be read or is one of another nest, the plan states no times, there is no such model, or the
        grid is too fine for the sheet or too coarse for its parts.
    """
    _expect_model(model)
    expect_one_torch(given.profile, "the simulation of heat", made if isinstance(made, Plan) else None)
    path = _path(made, given, tell, trusted)
    return _simulated(given, path, model, tell, frames)


def simulate_old(job: OldJob, model: HeatModel | None = None, tell: Tell = silent, frames: int = 0) -> Simulation:
    """Simulate an old program, on the nest that is told from its burns.

    Raises
    ------
    InputError
        If they make no nest; else as `simulate_made` does.
    """
    _expect_model(model)
    return _simulated(job.given, path_of_program(job.program, job.name), model, tell, frames)


def _expect_model(model: HeatModel | None) -> None:
    if model is not None and model not in MODELS:
        raise InputError(unknown("model of heat", str(model), MODELS))


def _simulated(given: Given, path: TimedPath, model: HeatModel | None, tell: Tell, frames: int) -> Simulation:
    nest, profile = given.nest, given.profile
    heat = replace(profile.heat, model=model) if model else profile.heat
    _tell_if_long(nest, path, heat, tell)
    thickness_mm = profile.material.thickness_mm
    if not frames or path.end_s <= 0:
        return Simulation(nest, heat, simulate(nest, path, heat, thickness_mm))
    from kerfwise.postproc.report.heat_map import HeatPicture

    picture, shown = HeatPicture(nest, make_grid(nest, heat.grid_mm), heat.ambient_c, heat.limit_c), dict[str, bytes]()

    def look(now_s: float, field: Any) -> None:
        if len(shown) < frames:
            name = f"frame_{len(shown) + 1:03d}.png"
            shown[name] = picture.png(field, f"{now_s / 60:.1f} min of {path.end_s / 60:.1f}")

    return Simulation(nest, heat, simulate(nest, path, heat, thickness_mm, (path.end_s / frames, look)), shown)


def _path(made: Plan | str | Path, given: Given, tell: Tell, trusted: Trusted | None) -> TimedPath:
    if not isinstance(made, Plan) and not is_plan_file(made):
        return path_of_program(read_program_of(made, given, tell, trusted), made)
    plan = made if isinstance(made, Plan) else read_plan(made)
    path = path_of_plan(plan, given.nest, given.profile)
    expect_short(path, None if isinstance(made, Plan) else made)
    for text in differences(plan, given):
        tell(text)
    return path


def _tell_if_long(nest: Nest, path: TimedPath, heat: Heat, tell: Tell) -> None:
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
