"""The command line names its outputs where it is run: each of these tests is run in an empty folder of its own."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Outputs of the README's first command, tried in the checkout, are in nobody's way."""
    folder = tmp_path_factory.mktemp("run-here")
    monkeypatch.chdir(folder)
    return folder
