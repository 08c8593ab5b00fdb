"""The facts at the top of a work sheet, and what the operator ticks."""

from __future__ import annotations

from collections.abc import Iterator

from kerfwise.jobs.resequence_table import clock_text
from kerfwise.postproc.report.legend import counted, duration

from .work_sheet import WorkSheet

_UNKNOWN = "as the machine has it"


def facts_of_sheet(sheet: WorkSheet) -> Iterator[tuple[str, str]]:
    """Names and values: stock, machine, feeds, settings, gas, time, lengths, cost."""
    plan, totals, report = sheet.plan, sheet.plan.totals, sheet.times.report
    machine, material = sheet.profile.machine, sheet.profile.material
    feeds = (("cut", machine.cut_feed_mm_s), ("mark", machine.mark_feed_mm_s), ("travel", machine.travel_mm_s))
    told = ", ".join(f"{name} {mm_s * 60:g}" for name, mm_s in feeds)
    spent = (
        ("cutting", report.cut_s),
        ("travelling", report.idle_s),
        ("piercing", report.pierce_s),
        *([("waiting", report.dwell_s)] if report.dwell_s else []),
    )
    shares = ", ".join(f"{name} {clock_text(seconds)}" for name, seconds in spent)
    yield "sheet", f"{_stock(sheet)}, {_parts(sheet)}"
    if sheet.nest.reading is not None and sheet.nest.reading.taken:
        yield "drawing", sheet.nest.reading.short()
    yield "machine", f"{machine.process}, {machine.dialect}; {_zero(sheet)}"
    yield "feeds", f"{told} mm/min; kerf {material.kerf_mm:g} mm, pierce {machine.pierce_time_s:g} s"
    yield "settings", _settings(sheet)
    yield "gas", material.gas or _UNKNOWN
    yield "time", f"{duration(report.total_s)} ({shares}; {report.model})"
    lengths = f"torch on {totals.cut_mm / 1000:.2f} m, idle {totals.idle_mm / 1000:.2f} m"
    passes = ", all of a zone or of the sheet first" if plan.pierces else ""
    yield "path", f"{lengths}, {counted(totals.pierces, 'pierce')}{passes}"
    if sheet.times.cost is not None:
        yield "cost", str(sheet.times.cost)
    if plan.already:
        again = "; the last is cut again" if plan.broken_off is not None else ""
        yield "goes on", f"after cut {plan.resumed_after}{again}"


def to_tick(sheet: WorkSheet) -> Iterator[str]:
    """What is looked at before the program starts, and after it ends."""
    yield f"sheet on the table: {_stock(sheet)}"
    yield f"zero set: {_zero(sheet)}"
    yield f"program loaded: {sheet.program_name}; its SHA-256 is that of the code above"
    yield f"settings: {_settings(sheet)}; gas: {sheet.profile.material.gas or _UNKNOWN}"
    yield f"{_parts(sheet)} counted and good; scrap: ______"


def _settings(sheet: WorkSheet) -> str:
    material = sheet.profile.material
    known = (
        ("{:g} A", material.amps),
        ("{:g} V", material.volts),
        ("power {:g} %", material.power),
        ("pierce power {:g} %", material.pierce_power),
        ("mark power {:g} %", material.mark_power),
        ("pierce height {:g} mm", material.pierce_height_mm),
        ("cut height {:g} mm", material.cut_height_mm),
    )
    return ", ".join(text.format(value) for text, value in known if value is not None) or _UNKNOWN


def _stock(sheet: WorkSheet) -> str:
    material, (left, bottom, right, top) = sheet.profile.material, sheet.nest.sheet.bounds
    assumed = " assumed" if sheet.nest.reading is not None and sheet.nest.reading.assumed else ""
    return f"{material.name}, {material.thickness_mm:g} mm, {right - left:g} × {top - bottom:g} mm{assumed}"


def _parts(sheet: WorkSheet) -> str:
    return counted(len({planned.part for planned in sheet.plan.cuts if planned.kind == "outer"}), "part")


def _zero(sheet: WorkSheet) -> str:
    x, y = sheet.plan.zero
    if sheet.plan.origin == "drawing":
        return "the machine's zero is that of the drawing"
    return f"the machine's zero is the sheet's corner, at ({x:g}, {y:g}) of the drawing"
