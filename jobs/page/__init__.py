"""The page of a plan, or of two: all that is known of it, gathered for the browser."""

from .page import compared_data, page_bytes, page_data

__all__ = ["compared_data", "page_bytes", "page_data"]
