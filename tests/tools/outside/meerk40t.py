"""MeerK40t's reader of programs for GRBL lasers, from PyPI (MIT): path and power.

It takes I and J without scaling them (its source: `ix = gc["i"].pop(0)  # * self.scale`, in 0.9.9100), so that its arcs
go wrong: it can judge programs of lines alone. It takes a move without a feed, too.
"""

from __future__ import annotations

import math
from typing import Any

from .heard import Heard, Point, length_mm


class _Laser:
    """Stands in for MeerK40t's driver: takes note of what is plotted and where it is sent, and of nothing else."""

    def __init__(self) -> None:
        self.plots: list[Any] = []

    def plot(self, plot: Any) -> None:
        self.plots.append(plot)

    def move_abs(self, x: float, y: float) -> None:
        self.plots.append((x, y))


def read(text: str) -> Heard:
    """What MeerK40t makes of a program, burn by burn: what is lit without a break."""
    from meerk40t.core.units import UNITS_PER_MM
    from meerk40t.grbl.gcodejob import GcodeJob
    from meerk40t.svgelements import Matrix

    fine = (
        100  # its device counts in whole units of which 2580 are a millimetre: a hundredth of that rounds nothing off
    )
    laser, answers = _Laser(), []
    job = GcodeJob(driver=laser, units_to_device_matrix=Matrix.scale(fine))
    job.reply = answers.append
    rows = [row for row in text.split("\n") if row.strip()]
    job.write_all(rows)
    while not job.execute():
        pass
    refused = [(row, answer) for row, answer in zip(rows, answers, strict=True) if not answer.startswith("ok")]
    assert not refused, refused[:3]
    heard = Heard()
    at: Point = (0.0, 0.0)
    lit = False
    for plot in laser.plots:
        if isinstance(plot, tuple):
            steps, unit = [(plot, 0.0)], UNITS_PER_MM
        elif hasattr(plot, "_points"):
            power = plot.settings["power"]
            steps = [(point, on * power) for point, on in zip(plot._points, [0.0, *plot._powers], strict=False)]
            unit = UNITS_PER_MM * fine
        else:
            continue
        for k, ((x, y), power) in enumerate(steps):
            point = (x / unit, y / unit)
            if hasattr(plot, "_points") and k == 0:
                assert math.dist(point, at) < 1e-3, "a plot begins where the beam is not"
                continue
            if power <= 0:
                heard.idle_mm += math.dist(at, point)
                lit = False
            else:
                if not lit:
                    heard.burns.append([at])
                    heard.powers.append(power)
                    lit = True
                heard.burns[-1].append(point)
                heard.powers[-1] = max(heard.powers[-1], power)
            at = point
    heard.lengths_mm = [length_mm(points) for points in heard.burns]
    return heard
