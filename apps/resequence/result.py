"""What became of an old program: what it does, what the new one does, and both as a table."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from kerfwise.encoder.display import align_columns
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.display import Picture
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.postproc.clock import time_program
from kerfwise.postproc.output_files import expect_outputs, write_files
from kerfwise.postproc.report.legend import clock_text
from kerfwise.rules.profile.technique import Technique

Paths = Literal["keep", "new"]
_TOLD = 3


@dataclass(frozen=True, eq=False, slots=True)
class Measured:
    """What a program does: mm, s, its burns and where the torch ends, and each rule's verdict on it.

    There is no verdict where there is no nest to judge by.
    """

    idle_mm: float
    cut_mm: float
    pierces: int
    time_s: float
    verdict: CheckResult | None
    burns: tuple[Burn, ...]
    end: Point

    @staticmethod
    def of(program: NcProgram, profile: Technique, nest: Nest | None, verdict: CheckResult | None) -> Measured:
        """What a program does by the time model of the profile."""
        timed = time_program(program, nest, profile)
        on_mm, pierces, time_s = timed.job.on_mm, timed.job.pierces, timed.times.total_s
        return Measured(program.idle_mm, on_mm, pierces, time_s, verdict, program.burns, program.end)


@dataclass(frozen=True, eq=False, slots=True)
class Resequenced:
    """An old program and the new one.

    Attributes
    ----------
    name
        Of the old program's file.
    paths
        "keep" where every burn stays as it is, "new" where contours were planned afresh.
    program
        The new program; the old one's text where nothing was gained.
    before, after
        What both do.
    nest
        Told from the burns; None where they make none.
    plan
        Of the new program, where there is a nest.
    proven
        Whether no order has less travel by the same rules.
    ends
        In a sentence, how the new order was found.
    notes
        What the user should know.
    home
        Where the torch starts, in the coordinates of the drawing that the program states.
    interrupted
        Whether Ctrl-C ended the planning: the order is the best so far.
    """

    name: str
    paths: Paths
    program: str
    before: Measured
    after: Measured
    nest: Nest | None
    plan: Plan | None
    proven: bool
    ends: str
    notes: tuple[str, ...]
    home: Point = (0.0, 0.0)
    interrupted: bool = False

    @property
    def changed(self) -> bool:
        """Whether the new program is another than the old one."""
        return self.before is not self.after

    def save(self, path: str | Path) -> Path:
        """Write the new program, whole or not at all; it may not take the place of the old one.

        Raises InputError if it cannot be written there.
        """
        path = Path(path)
        expect_outputs([path], [Path(self.name)])
        write_files({path: self.program})
        return path

    def picture(self, kind: Literal["svg", "png"] = "svg") -> Picture:
        """Both orders side by side."""
        from kerfwise.postproc.report.simple_pictures import Panel, draw_burns

        panels = [
            Panel(title, f"idle {of.idle_mm / 1000:.3f} m, {of.pierces} pierces", of.burns, self.home, of.end)
            for title, of in (("before", self.before), ("after", self.after))
        ]
        drawn = draw_burns(panels, f".{kind}", f"{Path(self.name).name} resequenced")
        return Picture(drawn.encode() if isinstance(drawn, str) else drawn, kind)

    def __str__(self) -> str:
        return table(self)


def table(result: Resequenced) -> str:
    """Idle travel, pierces, time, and the verdicts; below them what breaks a hard rule in the old order."""
    before, after = result.before, result.after
    rows = [
        ("idle travel", _metres(before.idle_mm), _metres(after.idle_mm), _change(before.idle_mm, after.idle_mm)),
        ("torch on", _metres(before.cut_mm), _metres(after.cut_mm), _change(before.cut_mm, after.cut_mm)),
        ("pierces", str(before.pierces), str(after.pierces), _difference(before.pierces, after.pierces)),
        ("time", clock_text(before.time_s), clock_text(after.time_s), _change(before.time_s, after.time_s)),
    ]
    if before.verdict is not None and after.verdict is not None:
        now = {judgement.id: judgement for judgement in after.verdict.rules}
        for judgement in before.verdict.rules:
            if judgement.strength != "off" and judgement.id in now:
                then = judgement.verdict, now[judgement.id].verdict
                rows.append((f"{judgement.strength} {judgement.id}", *then, "" if then[0] == then[1] else "changed"))
    head = ("", "before", "after", "")
    lines = [*align_columns([head, *rows]), *_broken(result)]
    lines.append(result.ends if result.changed else f"unchanged: {result.ends}")
    return "\n".join(lines)


def _broken(result: Resequenced) -> list[str]:
    """What breaks hard rules in the old order."""
    lines: list[str] = []
    for judgement in result.before.verdict.rules if result.before.verdict is not None else ():
        if judgement.strength == "hard" and judgement.violations:
            lines += [f"before: {judgement.id}: {escape_text(v.text)}" for v in judgement.violations[:_TOLD]]
            if len(judgement.violations) > _TOLD:
                lines.append(f"before: {judgement.id}: ... and {len(judgement.violations) - _TOLD} more")
    return lines


def _metres(mm: float) -> str:
    return f"{mm / 1000:.3f} m"


def _change(before: float, after: float) -> str:
    return "" if before <= 0 or abs(after - before) < 1e-6 else f"{(after - before) / before:+.1%}"


def _difference(before: int, after: int) -> str:
    return "" if before == after else f"{after - before:+d}"


# Minutes and seconds, as tables of jobs have them.
