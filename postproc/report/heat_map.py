"""Temperatures of a sheet as a picture: the colour of every point, the contours, what is too hot, and a colour bar."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools
from kerfwise.encoder.nest import Nest
from kerfwise.models.physics.heat import HeatResult
from kerfwise.models.physics.heat.grid import SCRAP, Grid

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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
        said = "blue line: limit"
        if counted is not None:
            self._fill(axes, self.grid.metal & ~counted, _BAND)
            self._fill(axes, self.grid.metal & (self.grid.part == SCRAP), _SCRAP)
            self._fill(axes, counted & (field > self.limit_c), _HOT)
            said = "blue: hotter than the limit · grey: the kerf's band and (lighter) scrap, which are not counted"
        self._draw_limit(axes, shown)
        self._draw_contours(axes)
        axes.set_title(f"{title}\n{said}", fontsize=10, loc="left")
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
