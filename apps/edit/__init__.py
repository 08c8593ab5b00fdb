"""Nests that change: one model of an edit, for the command line, the page and Python."""
