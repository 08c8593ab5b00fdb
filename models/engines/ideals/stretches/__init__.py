"""A sweep in stretches, one zone after another: its tables, and bounds of what is left."""
