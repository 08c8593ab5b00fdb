"""Read an NC program with LinuxCNC's own interpreter (`rs274`) and say what the machine would do.

`rs274` does all the interpretation: modal state, G90/G91, G20/G21, arcs, refusals. This module only runs it, reads the
canonical calls it prints and adds them up. `sh tests/tools/get_rs274.sh .tools/rs274` fetches the interpreter.
"""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
Point = tuple[float, float]
Axes = tuple[float, float, float]


class MissingInterpreter(AssertionError):
    """rs274 is not on this machine: a test that needs it fails, and says how to get it."""


def find_rs274() -> str:
    """The interpreter: $RS274, else the one in .tools, else the one on the PATH."""
    places = (os.environ.get("RS274"), str(ROOT / ".tools/rs274/bin/rs274"), shutil.which("rs274"))
    for place in places:
        if place and os.access(place, os.X_OK):
            return place
    raise MissingInterpreter(
        "LinuxCNC's rs274 is missing: `sh tests/tools/get_rs274.sh .tools/rs274` fetches it (or set RS274)"
    )


@dataclass(slots=True)
class Burn:
    """One stretch with a tool on (torch $0, scribe $1): its points (arcs as chords within the tolerance), mm.

    `axes` are A, B and C at the end of each line and arc, the first where it begins, degrees.
    """

    tool: int
    points: list[Point]
    first_block: int | None
    length_mm: float = 0.0
    feeds_mm_min: list[float] = field(default_factory=list)
    sweeps_rad: list[float] = field(default_factory=list)
    axes: list[Axes] = field(default_factory=list)

    @property
    def pierce(self) -> Point:
        """Where the tool came on."""
        return self.points[0]


@dataclass(slots=True)
class Run:
    """What the machine would do, mm and s. `error` is rs274's message when it refuses the program.

    `ways` are all moves with no tool on, their points, arcs as chords.
    """

    error: str | None = None
    refused_line: str = ""
    ended: str | None = None
    burns: list[Burn] = field(default_factory=list)
    rapids: list[tuple[Point, Point]] = field(default_factory=list)
    dry_feeds: list[tuple[Point, Point]] = field(default_factory=list)
    dwell_s: float = 0.0
    arc_mismatch_mm: float = 0.0
    comments: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    position: Point = (0.0, 0.0)
    ways: list[list[Point]] = field(default_factory=list)

    @property
    def cuts(self) -> list[Burn]:
        """The stretches with the torch on."""
        return [b for b in self.burns if b.tool == 0]

    @property
    def marks(self) -> list[Burn]:
        """The stretches with another tool on."""
        return [b for b in self.burns if b.tool != 0]

    @property
    def idle_mm(self) -> float:
        """Length of the rapids, mm."""
        return sum(math.dist(a, b) for a, b in self.rapids)


def run(text: str | bytes, tolerance_mm: float = 0.005, kerf_mm: float = 0.0) -> Run:
    """Interpret a program; arcs become chords within `tolerance_mm`. Tool 1 is as wide as the kerf."""
    code, canon, errors = _run_rs274(text, kerf_mm)
    machine = _Machine(tolerance_mm)
    machine.follow(_calls(canon))
    if code != 0:
        lines = [e for e in errors.splitlines() if e.strip() and e.strip() != "executing"]
        machine.run.error = lines[0] if lines else f"rs274 ended with exit code {code}"
        machine.run.refused_line = lines[1] if len(lines) > 1 else ""
    return machine.run


def _run_rs274(text: str | bytes, kerf_mm: float) -> tuple[int, str, str]:
    with tempfile.TemporaryDirectory(prefix="canon-") as name:
        folder = Path(name)
        (folder / "in.ngc").write_bytes(text if isinstance(text, bytes) else text.encode())
        (folder / "x.var").touch()
        (folder / "tool.tbl").write_text(f"T1 P1 D{kerf_mm / 25.4:.9f}\n")  # in the machine's own units
        # M3 $1 is refused unless the machine has several spindles
        ini = "[RS274NGC]\nPARAMETER_FILE = x.var\n[TRAJ]\nSPINDLES = 8\n[AXIS_Z]\nMAX_LIMIT = 100\n"
        (folder / "x.ini").write_text(ini)
        env = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")} | {
            "LC_ALL": "C",
            "HOME": name,
        }  # its file of tools
        # -g: no questions; an output file, because rs274's stdout is unbuffered and ten times slower
        words = [find_rs274(), "-g", "-n", "2", "-i", "x.ini", "-v", "x.var", "-t", "tool.tbl", "in.ngc", "out.canon"]
        done = subprocess.run(
            words, cwd=folder, env=env, stdin=subprocess.DEVNULL, capture_output=True, timeout=120, check=False
        )
        out = folder / "out.canon"
        canon = out.read_text(encoding="utf-8", errors="replace") if out.exists() else ""
        return done.returncode, canon, (done.stderr + done.stdout).decode("utf-8", "replace")


_CALL = re.compile(r"^\s*\d+ N(\d*|\.{5}) *([A-Z][A-Z0-9_.]*) ?\((.*)\)\s*$")
# what M2 and M30 themselves emit, from SET_G5X_OFFSET on: they stop every spindle, so a forgotten M5 would not show
_EPILOGUE = {
    "SET_G5X_OFFSET", "SET_XY_ROTATION", "SELECT_PLANE", "SET_FEED_MODE", "SET_FEED_RATE", "ENABLE_FEED_OVERRIDE",
    "STOP_SPINDLE_TURNING", "SET_SPINDLE_MODE", "MIST_OFF", "FLOOD_OFF", "PALLET_SHUTTLE",
}  # fmt: skip
_IGNORED = {
    "ON_RESET", "SELECT_PLANE", "SET_FEED_MODE", "SET_FEED_REFERENCE",
    "ENABLE_FEED_OVERRIDE", "DISABLE_FEED_OVERRIDE", "ENABLE_SPEED_OVERRIDE", "DISABLE_SPEED_OVERRIDE",
    "SET_SPINDLE_MODE", "SET_SPINDLE_SPEED", "MIST_OFF", "FLOOD_OFF", "PALLET_SHUTTLE", "SET_MOTION_CONTROL_MODE",
    "SET_NAIVECAM_TOLERANCE",
    "SET_AUX_OUTPUT_VALUE", "SET_MOTION_OUTPUT_VALUE", "MESSAGE", "PROGRAM_STOP", "OPTIONAL_PROGRAM_STOP", "FINISH",
    "MIST_ON", "FLOOD_ON", "ENABLE_ADAPTIVE_FEED", "DISABLE_ADAPTIVE_FEED", "ENABLE_FEED_HOLD", "DISABLE_FEED_HOLD",
}  # fmt: skip
# name -> how many of its numbers come before the offsets themselves
_OFFSETS = {"SET_G5X_OFFSET": 1, "SET_G92_OFFSET": 0, "SET_XY_ROTATION": 0, "USE_TOOL_LENGTH_OFFSET": 0}
MARKS_BY = 0
"""The digital output that marks, where M3 has but one tool."""
Call = tuple[int | None, str, str]


def _calls(canon: str) -> list[Call]:
    calls: list[Call] = []
    for line in filter(str.strip, canon.split("\n")):  # a comment may hold what splitlines takes for a line's end
        found = _CALL.match(line)
        if found is None:
            calls.append((None, "?", line))
        else:
            calls.append((int(found[1]) if found[1].isdigit() else None, found[2], found[3]))
    return calls


def _numbers(text: str) -> list[float]:
    return [float(v) for v in re.split(r"[,\s]+", text.strip()) if v]


class _Machine:
    """Follows the canonical calls."""

    def __init__(self, tolerance_mm: float) -> None:
        self.tolerance_mm = tolerance_mm
        self.unit_mm = 1.0
        self.feed_mm_min = 0.0
        self.on: set[int] = set()
        self.burn: Burn | None = None
        self.axes: Axes = (0.0, 0.0, 0.0)
        self.run = Run()

    def follow(self, calls: list[Call]) -> None:
        end = next((k for k, c in enumerate(calls) if c[1] == "PROGRAM_END"), None)
        epilogue = len(calls)
        if end is not None:
            k = end - 1
            while k >= 0 and calls[k][1] in _EPILOGUE:
                epilogue, k = (k if calls[k][1] == "SET_G5X_OFFSET" else epilogue), k - 1
            self.run.ended = "M30" if calls[end - 1][1] == "PALLET_SHUTTLE" else "M2"
        for block, name, argument in calls[:epilogue]:
            self._call(block, name, argument)
        if self.on:
            self._warn(None, "program ends with the torch on")

    def _warn(self, block: int | None, text: str) -> None:
        self.run.warnings.append(text if block is None else f"N{block}: {text}")

    def _call(self, block: int | None, name: str, argument: str) -> None:
        if name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            x, y, _, *axes = _numbers(argument)[:6]
            self._turn(axes)
            self._line(block, name == "STRAIGHT_TRAVERSE", (x * self.unit_mm, y * self.unit_mm))
        elif name == "ARC_FEED":
            self._arc(block, _numbers(argument))
        elif name in ("START_SPINDLE_CLOCKWISE", "START_SPINDLE_COUNTERCLOCKWISE"):
            self._start(block, int(argument))
        elif name == "STOP_SPINDLE_TURNING":
            self._stop(int(argument))
        elif name == "SET_AUX_OUTPUT_BIT" and int(argument) == MARKS_BY:
            self._start(block, 1)
        elif name == "CLEAR_AUX_OUTPUT_BIT" and int(argument) == MARKS_BY:
            self._stop(1)
        elif name == "USE_LENGTH_UNITS":
            self.unit_mm = 25.4 if "INCHES" in argument else 1.0
        elif name == "SET_FEED_RATE":
            self.feed_mm_min = _numbers(argument)[0] * self.unit_mm
        elif name == "DWELL":
            self.run.dwell_s += _numbers(argument)[0]
        elif name == "COMMENT":
            text = argument.strip('"')
            if not text.startswith("interpreter:"):
                self.run.comments.append(text)
        elif name in _OFFSETS:
            if any(_numbers(argument)[_OFFSETS[name] :]):
                self._warn(block, f"an offset that is not followed here: {name}({argument})")
        elif name not in _IGNORED:
            self._warn(block, f"not understood: {name}({argument})")

    def _start(self, block: int | None, tool: int) -> None:
        if self.on:
            self._warn(block, f"tool ${tool} started while ${min(self.on)} is on")
        self.on.add(tool)
        if self.burn is None:
            self.burn = Burn(tool, [self.run.position], block, axes=[self.axes])
            self.run.burns.append(self.burn)

    def _stop(self, tool: int) -> None:
        self.on.discard(tool)
        if self.burn is not None and self.burn.tool not in self.on:
            self.burn = None

    def _turn(self, axes: list[float]) -> None:
        self.axes = (axes[0], axes[1], axes[2])
        if self.burn is not None:
            self.burn.axes.append(self.axes)

    def _line(self, block: int | None, rapid: bool, end: Point) -> None:
        start, self.run.position = self.run.position, end
        if start == end:
            return
        if self.burn is not None:
            if rapid:
                self._warn(block, f"rapid with the torch on, {math.dist(start, end):.3f} mm")
            self._add([end], math.dist(start, end))
        else:
            (self.run.rapids if rapid else self.run.dry_feeds).append((start, end))
            self.run.ways.append([start, end])

    def _arc(self, block: int | None, values: list[float]) -> None:
        ex, ey, cx, cy, turn = (v * self.unit_mm for v in values[:5])
        self._turn(values[6:9])
        start, end, centre = self.run.position, (ex, ey), (cx, cy)
        if math.dist(start, end) < 0.75e-4 * self.unit_mm:  # the same printed position is a full circle
            end = start
        a0 = math.atan2(start[1] - cy, start[0] - cx)
        sweep = (math.atan2(end[1] - cy, end[0] - cx) - a0) % math.tau
        if turn < 0:
            sweep -= math.tau
        if start == end:
            sweep = math.copysign(math.tau, turn)
        if start != end and min(abs(sweep), math.tau - abs(sweep)) < 1e-3:
            self._warn(block, f"arc sweep {sweep:.6f} rad: almost nothing or almost a full turn, controls may disagree")
        r0, r1 = math.dist(start, centre), math.dist(end, centre)
        self.run.arc_mismatch_mm = max(self.run.arc_mismatch_mm, abs(r0 - r1))
        step = min(max(2 * math.acos(1 - min(self.tolerance_mm / max(r0, r1), 1.0)), 1e-4), math.pi / 2)
        n = max(1, math.ceil(abs(sweep) / step - 1e-9))
        points = []
        for k in range(1, n):
            r, a = r0 + (r1 - r0) * k / n, a0 + sweep * k / n
            points.append((cx + r * math.cos(a), cy + r * math.sin(a)))
        self.run.position = end
        if self.burn is None:
            self.run.dry_feeds.append((start, end))
            self.run.ways.append([start, *points, end])
            return
        self.burn.sweeps_rad.append(sweep)
        self._add([*points, end], (r0 + r1) / 2 * abs(sweep))

    def _add(self, points: list[Point], length_mm: float) -> None:
        assert self.burn is not None
        self.burn.points += points
        self.burn.length_mm += length_mm
        if self.feed_mm_min not in self.burn.feeds_mm_min:
            self.burn.feeds_mm_min.append(self.feed_mm_min)
