"""Verdicts: what the check needs handed to it, and its answer about a plan and its program."""
