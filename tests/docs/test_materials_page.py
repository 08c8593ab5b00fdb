"""docs/materials.md shows what its example says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import kerfwise
from kerfwise.postproc.dialects import load_dialect
from kerfwise.postproc.nc.head_comments import setting_comments
from kerfwise.rules.profile.load import load_profile
from kerfwise.tests.commands import run_cli

ROOT = Path(kerfwise.__file__).parent
PAGE = (ROOT / "docs" / "materials.md").read_text(encoding="utf-8")


@pytest.fixture(autouse=True)
def there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)


def test_what_profile_check_says() -> None:
    (shown,) = re.findall(r"^```console\n\$ kerfwise (.+)\n((?:.+\n)*?)…\n```", PAGE, re.MULTILINE)
    ended = run_cli.kerfwise(*shown[0].split())
    assert ended.code == 0
    assert set(shown[1].splitlines()) <= set(ended.out.splitlines())
    assert "are interpolated between 6 mm (line 5) and 10 mm (line 6)" in ended.err


def test_the_comments_of_the_program() -> None:
    comments = list(setting_comments(load_profile("examples/profiles/charted.yaml"), load_dialect("linuxcnc")))
    shown = re.findall(r"^\((?:CHART|INTERPOLATED|SET) .+\)$", PAGE, re.MULTILINE)
    assert len(shown) == 3
    assert set(shown) <= set(comments)


def test_the_example_for_a_laser_is_read() -> None:
    from kerfwise.rules.charts import read_chart

    rows = read_chart("examples/charts/plywood.yaml").rows
    assert [row.names for row in rows] == [("ply4",), ("ply8",)]
