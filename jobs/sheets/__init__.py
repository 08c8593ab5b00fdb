"""Work sheets: what the operator has on paper beside the machine."""

from .about import about_of_job
from .layout import sheets_pdf
from .work_sheet import WorkSheet, work_sheet

__all__ = ["WorkSheet", "about_of_job", "sheets_pdf", "work_sheet"]
