"""Material charts: what a plant knows of cutting each material in each thickness, in a file of its own."""

from .chart import Chart, ChartRow
from .lookup import Found, LookedUp, NoRow, look_up
from .read import read_chart
from .row_choice import ROW_CHOICE, RowChoice

__all__ = ["ROW_CHOICE", "Chart", "ChartRow", "Found", "LookedUp", "NoRow", "RowChoice", "look_up", "read_chart"]
