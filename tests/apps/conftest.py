"""Verbs of apps name their outputs where they are run, as those of the core do."""

from __future__ import annotations

from kerfwise.tests.commands.conftest import in_an_empty_folder

__all__ = ["in_an_empty_folder"]
