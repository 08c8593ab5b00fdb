"""kerfwise heat: how hot a plan or a program makes the sheet, where, and for how long."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.encoder.errors import InputError

from .given import Given, given_options, note_if_others, read_given, read_program_of

if TYPE_CHECKING:
    from kerfwise.encoder.nest import Nest
    from kerfwise.models.physics.heat import HeatResult, PartHeat, TimedPath
    from kerfwise.rules.profile.heat_section import Heat
    from kerfwise.rules.profile.profile import Profile

FRAMES = 60
_SHOWN = 15
"""Parts that the table lists."""
_POINT_STEPS_A_SECOND, _LONG_S = 5e8, 60.0
"""What one core of a usual machine simulates at the least, and how long goes without saying."""


@click.command()
@given_options
@click.option("--model", type=click.Choice(["physical", "logical"]), help="Instead of the profile's heat.model.")
@click.option("--json", "as_json", is_flag=True, help="Print model, overheats, peak_c, grid_mm, energy_error and more.")
@click.option("-o", "--output", metavar="MAP.png", help="A picture of the highest temperature of every point.")
@click.option("--frames", metavar="DIR", help=f"{FRAMES} pictures of the sheet, evenly over the program.")
@click.argument("made", metavar="PLAN.json|OUT.nc")
def command(made: str, model: Any, as_json: bool, output: str | None, frames: str | None, **given: Any) -> None:
    """Simulate how hot a plan or an NC program makes the sheet of NEST, and count the points that get too hot."""
    if output and Path(output).suffix.lower() != ".png":
        raise InputError(f"cannot draw temperatures as {Path(output).suffix or output!r}: give a name ending in .png")
    from kerfwise.postproc.files import expect_folders, expect_place, make_folder, write_files
    from kerfwise.postproc.report.heat_map import peak_map

    if output:
        expect_folders([Path(output)])
    if frames:
        expect_place(Path(frames))

    asked = read_given(**given)
    nest, profile = asked.nest, asked.profile
    if model:
        profile = replace(profile, heat=replace(profile.heat, model=model))
    path = _path(made, asked)
    _note_if_long(nest, path, profile.heat)
    result, files = _simulated(nest, path, profile, Path(frames) if frames else None)
    if output:
        files[Path(output)] = peak_map(nest, result, profile.heat.ambient_c)
    if frames:
        make_folder(Path(frames))
    write_files(files)
    click.echo(json.dumps(_data(result)) if as_json else _table(result))


def _path(made: str, given: Given) -> TimedPath:
    from kerfwise.models.plan.reader import read_plan
    from kerfwise.postproc.clock.heat_path import path_of_plan, path_of_program

    if made.endswith(".json"):
        plan = read_plan(made)
        path = path_of_plan(plan, given.nest, given.profile)
        note_if_others(plan, given)
        return path
    return path_of_program(read_program_of(made, given))


def _note_if_long(nest: Nest, path: TimedPath, heat: Heat) -> None:
    """Say beforehand what a fine grid will cost: the work goes with the fourth power of its fineness."""
    from kerfwise.models.physics.heat.grid import MOST_POINTS
    from kerfwise.models.physics.heat.physical import point_steps
    from kerfwise.postproc.report.legend import duration

    area_mm2 = nest.sheet.polygon.area
    longest_s = point_steps(area_mm2, path.end_s, heat) / _POINT_STEPS_A_SECOND
    refused = area_mm2 / heat.grid_mm**2 > MOST_POINTS
    if heat.model == "physical" and heat.absorbed_power_w and longest_s > _LONG_S and not refused:
        wider_mm = heat.grid_mm * (longest_s / _LONG_S) ** 0.25
        took = f"a grid of {heat.grid_mm:g} mm takes up to about {duration(longest_s)} here"
        click.echo(f"note: {took}, one of {wider_mm:.2g} mm a minute (heat.grid); Ctrl-C ends it", err=True)


def _simulated(
    nest: Nest, path: TimedPath, profile: Profile, frames: Path | None
) -> tuple[HeatResult, dict[Path, str | bytes]]:
    """What the simulation found, and the frames of its animation."""
    from kerfwise.models.physics.heat import simulate
    from kerfwise.models.physics.heat.grid import make_grid
    from kerfwise.postproc.report.heat_map import HeatPicture

    heat, files = profile.heat, dict[Path, str | bytes]()
    if frames is None or path.end_s <= 0:
        return simulate(nest, path, heat, profile.material.thickness_mm), files
    picture = HeatPicture(nest, make_grid(nest, heat.grid_mm), heat.ambient_c, heat.limit_c)

    def look(now_s: float, field: Any) -> None:
        if len(files) < FRAMES:
            name = f"frame_{len(files) + 1:03d}.png"
            files[frames / name] = picture.png(field, f"{now_s / 60:.1f} min of {path.end_s / 60:.1f}")

    return simulate(nest, path, heat, profile.material.thickness_mm, (path.end_s / FRAMES, look)), files


def _told(part: PartHeat) -> str:
    return "-" if part.peak_c is None else f"{part.peak_c:.1f}"


def _data(result: HeatResult) -> dict[str, Any]:
    error = result.energy_error
    return {
        "model": result.model,
        "overheats": result.overheats,
        "peak_c": round(result.peak_c, 2),
        "grid_mm": result.grid.step_mm,
        "energy_error": None if error is None else round(error, 8),
        "limit_c": result.limit_c,
        "above_s": round(result.above_s, 2),
        "parts": [
            {
                "part": p.part,
                "peak_c": None if p.peak_c is None else round(p.peak_c, 2),
                "overheats": p.overheats,
                "above_s": round(p.above_s, 2),
            }
            for p in result.parts
        ],
    }


def _table(result: HeatResult) -> str:
    grid_mm = result.grid.step_mm
    lines = [
        f"{'model':10} {result.model}, grid {grid_mm:g} mm",
        f"{'peak':10} {result.peak_c:.1f} °C outside the kerf's band, limit {result.limit_c:g} °C",
        f"{'overheats':10} {result.overheats} points, {result.overheats * grid_mm**2 / 100:.1f} cm²",
        f"{'too hot':10} {result.above_s:.0f} s at the longest",
    ]
    if result.energy_error is not None:
        lines.append(f"{'energy':10} {result.energy_error:.2e} of what was put in is not accounted for")
    parts = sorted(result.parts, key=lambda p: (-p.overheats, -(p.peak_c or 0.0), p.part))
    width = max([4, *(len(p.part) for p in parts[:_SHOWN])])
    lines += ["", f"{'part':{width}} {'peak °C':>9} {'overheats':>10} {'too hot, s':>11}"]
    lines += [f"{p.part:{width}} {_told(p):>9} {p.overheats:10d} {p.above_s:11.0f}" for p in parts[:_SHOWN]]
    if len(parts) > _SHOWN:
        lines.append(f"… and {len(parts) - _SHOWN} cooler parts")
    if unseen := sum(p.peak_c is None for p in parts):
        lines.append(f"no point of {unseen} narrow part{'s' if unseen > 1 else ''} (-) lies outside the kerf's band")
    return "\n".join(lines)
