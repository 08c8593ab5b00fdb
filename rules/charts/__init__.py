"""Material charts: what a plant knows of cutting each material in each thickness, in a file of its own."""

from .chart import ROW_CHOICE, Chart, ChartRow, Found, LookedUp, NoRow, RowChoice, look_up
from .read_chart import read_chart

__all__ = ["ROW_CHOICE", "Chart", "ChartRow", "Found", "LookedUp", "NoRow", "RowChoice", "look_up", "read_chart"]
