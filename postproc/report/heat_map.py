"""Temperatures of a sheet as a picture: the colour of every point, the parts, what was too hot, and a colour bar."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...encoder.nest import Nest
from ...models.heat import HeatResult
from ...models.heat.grid import Bools, Grid

LONG_SIDE_INCHES = 12.0
DPI = 120
OVER = 1.6
"""The colours reach so many times as far above the air as the limit does."""


@dataclass(frozen=True, eq=False, slots=True)
class HeatPicture:
    """Draws maps of one sheet, all in the same colours."""

    nest: Nest
    grid: Grid
    ambient_c: float
    limit_c: float

    def png(self, field: NDArray[np.float32], title: str, marked: Bools | None = None) -> bytes:
        """A PNG of temperatures (nx, ny), °C; points of `marked` are shown in blue."""
        # Loading matplotlib takes longer than most verbs: only those who want a picture pay for it.
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.collections import LineCollection
        from matplotlib.colors import ListedColormap
        from matplotlib.figure import Figure

        nx, ny = self.grid.shape
        scale = LONG_SIDE_INCHES / max(nx, ny)
        figure = Figure(figsize=(max(nx * scale, 4.0) + 1.4, max(ny * scale, 2.0) + 1.0), dpi=DPI, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        x0, y0 = self.grid.x0_mm - self.grid.step_mm / 2, self.grid.y0_mm - self.grid.step_mm / 2
        extent = (x0, x0 + nx * self.grid.step_mm, y0, y0 + ny * self.grid.step_mm)
        shown = np.where(self.grid.metal, field, np.nan)
        hottest_c = self.ambient_c + OVER * (self.limit_c - self.ambient_c)
        image = axes.imshow(
            shown.T, origin="lower", extent=extent, cmap="inferno", vmin=self.ambient_c, vmax=hottest_c,
            interpolation="nearest",
        )  # fmt: skip
        if marked is not None and marked.any():
            points = np.where(marked, 1.0, np.nan).T
            axes.imshow(
                points, origin="lower", extent=extent, cmap=ListedColormap(["#35b6ff"]), interpolation="nearest"
            )
        lines = [np.asarray(contour.line.coords) for contour in self.nest.contours if contour.kind != "mark"]
        axes.add_collection(LineCollection(lines, colors="white", linewidths=0.5, alpha=0.7))
        axes.set_title(title, fontsize=10, loc="left")
        axes.tick_params(labelsize=7)
        axes.set_xlabel("mm", fontsize=8)
        bar = figure.colorbar(image, ax=axes, extend="max", fraction=0.04, pad=0.01)
        bar.ax.axhline(self.limit_c, color="#35b6ff", linewidth=2)
        bar.set_label(f"°C (blue: limit {self.limit_c:g} °C)", fontsize=8)
        bar.ax.tick_params(labelsize=7)
        file = io.BytesIO()
        figure.savefig(file, format="png", metadata={"Software": None})
        return file.getvalue()


def peak_map(nest: Nest, result: HeatResult, ambient_c: float) -> bytes:
    """The highest temperature of every point, with the overheats in blue."""
    picture = HeatPicture(nest, result.grid, ambient_c, result.limit_c)
    title = f"peak temperature, {result.model} model, {result.grid.step_mm:g} mm grid: {result.overheats} overheats"
    return picture.png(result.run.peak_c, title, result.counted & (result.run.peak_c > result.limit_c))
