"""What a profile says of the machine: what it can do, how far it reaches, and the language its control speaks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from kerfwise.encoder.geometry.segment import Point
from kerfwise.rules.options.members import Members
from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Choice, Flag, Number
from kerfwise.rules.options.quantities import DURATION, LENGTH, SPEED, LengthSpan, OrWord, PointXY, over_zero

from .dialect_kind import DialectName

Process = Literal["plasma", "oxyfuel", "laser", "water-jet"]
PROCESSES: tuple[Process, ...] = ("plasma", "oxyfuel", "laser", "water-jet")
DIALECTS = ("burny", "eia", "essi", "grbl", "linuxcnc", "linuxcnc-qtplasmac")
Origin = Literal["drawing", "sheet-corner"]
ORIGINS: tuple[Origin, ...] = ("drawing", "sheet-corner")
PierceDwell = Literal["machine", "program"]
MACHINE_WAITS = (
    "a control that holds the pierce delay itself probes for the sheet and waits at every start, also beside the "
    "sheet: say false, or machine.pierce_dwell: program where the control does neither"
)
"""Why edge starts, and starts in kerfs, do not go with a pierce delay in the machine."""
_SPAN = LengthSpan(none="unknown")
Axis = Literal["x", "y"]


@dataclass(frozen=True, slots=True)
class Torches:
    """Torches on one gantry, which follow the same path side by side."""

    count: int = field(default=1, metadata=option(Number(1, 8, whole=True), "torches on the gantry"))
    spacing_mm: float = field(default=0.0, metadata=option(LENGTH, "from each torch to the next"))
    axis: Axis = field(default="y", metadata=option(Choice(("x", "y")), "the axis along which they stand, upwards"))
    up_to_mm: float | None = field(
        default=None,
        metadata=option(
            OrWord(over_zero(LENGTH), "spacing"), "where torches can be moved: the greatest spacing, spacing the least"
        ),
    )

    @property
    def apart(self) -> str:
        """How far they stand apart, as a person says it, and along which axis."""
        most = "" if self.up_to_mm is None else f" to {self.up_to_mm:g}"
        return f"{self.spacing_mm:g}{most} mm apart along {self.axis.upper()}"

    @property
    def several(self) -> bool:
        """Whether there are more than one."""
        return self.count > 1

    @property
    def step(self) -> Point:
        """From each torch to the next, mm."""
        return (self.spacing_mm, 0.0) if self.axis == "x" else (0.0, self.spacing_mm)

    def shift(self, torch: int) -> Point:
        """From torch 1 to another, mm.

        Examples
        --------
        >>> Torches(3, 200.0, "x").shift(3)
        (400.0, 0.0)
        """
        x, y = self.step
        return x * (torch - 1), y * (torch - 1)


@dataclass(frozen=True, slots=True)
class Machine:
    """What the machine can do, and the language its control speaks."""

    process: Process = field(default="plasma", metadata=option(Choice(PROCESSES), "what cuts"))
    dialect: str = field(
        default="linuxcnc-qtplasmac",
        metadata=option(DialectName(DIALECTS), "language of the NC program"),
    )
    accept_dialect: bool = field(
        default=False, metadata=option(Flag(), "write in this dialect although it is for another process")
    )
    home: Point = field(
        default=(0.0, 0.0), metadata=option(PointXY(), "where the torch starts and returns to, in machine coordinates")
    )
    origin: Origin = field(
        default="drawing",
        metadata=option(Choice(ORIGINS), "the machine's zero: that of the drawing, or the sheet's corner"),
    )
    travel_x_mm: Point | None = field(default=None, metadata=option(_SPAN, "least and most X that the torch can go to"))
    travel_y_mm: Point | None = field(default=None, metadata=option(_SPAN, "least and most Y that the torch can go to"))
    cut_feed_mm_s: float = field(default=2500 / 60, metadata=option(SPEED, "speed while cutting"))
    mark_feed_mm_s: float = field(default=100.0, metadata=option(SPEED, "speed while marking"))
    travel_mm_s: float = field(default=250.0, metadata=option(SPEED, "speed of idle travel"))
    pierce_time_s: float = field(default=0.5, metadata=option(DURATION, "time to pierce"))
    pierce_dwell: PierceDwell | None = field(
        default=None,
        metadata=option(
            Choice(("dialect", "machine", "program"), none="dialect"), "who waits for the pierce (dialect: as it says)"
        ),
    )
    edge_preheat_s: float = field(
        default=0.0, metadata=option(DURATION, "time to preheat the sheet's edge before an edge start")
    )
    kerf_start: bool = field(
        default=True,
        metadata=option(Flag(), "begin in an old kerf as at the sheet's edge; false: wait as long as for a pierce"),
    )
    torches: Torches = field(
        default=Torches(), metadata=option(Members(Torches), "torches side by side, for nests of copies")
    )
    mark_time_s: float = field(default=0.2, metadata=option(DURATION, "time to start marking"))
    head: str = field(
        default="up", metadata=option(Choice(("up", "down")), "whether the head is lifted on idle travel")
    )

    @property
    def unpierced_s(self) -> float:
        """How long the torch stands, lit, where a cut begins without a pierce: at the sheet's edge, or in an old kerf.

        A flame cuts no cold metal: where the profile has no preheat of its own it takes as long as for a pierce.
        """
        if self.process == "oxyfuel" and self.edge_preheat_s <= 0:
            return self.pierce_time_s
        return self.edge_preheat_s

    @property
    def at_hole_s(self) -> float:
        """How long it stands at a hole that was pierced before: a flame has to heat its edge again."""
        return self.unpierced_s if self.process == "oxyfuel" else 0.0
