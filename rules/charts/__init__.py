"""Material charts: what a plant knows of cutting each material in each thickness, in a file of its own."""

from .chart import ROW_CHOICE, Chart, ChartRow, Found, LookedUp, NoRow, RowChoice, look_up
from .read_chart import qtplasmac_text, read_chart, shipped_charts

__all__ = [
    "ROW_CHOICE",
    "Chart",
    "ChartRow",
    "Found",
    "LookedUp",
    "NoRow",
    "RowChoice",
    "look_up",
    "qtplasmac_text",
    "read_chart",
    "shipped_charts",
]
