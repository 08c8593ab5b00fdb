"""Prices of an overheat that plans are made at where nobody names others."""

PRICES_MM = (0.0, 10.0, 30.0, 100.0, 300.0)
"""In mm of idle travel."""
