"""Work sheets: what the operator has on paper beside the machine."""

from .layout import sheets_pdf
from .work_sheet import WorkSheet, work_sheet

__all__ = ["WorkSheet", "sheets_pdf", "work_sheet"]
