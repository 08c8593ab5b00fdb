"""The published schema is the one that lists are read by; what it takes and refuses is what the reader does."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

import jsonschema
import pytest
import yaml

import kerfwise
from kerfwise.apps.nesting.part_list import list_of, list_schema, schema_text
from kerfwise.encoder.errors import InputError
from kerfwise.tests.commands.run_cli import kerfwise as run

VALIDATOR = jsonschema.Draft202012Validator(list_schema())
DAY = Path(kerfwise.__file__).parent / "examples" / "parts" / "day.yaml"


def test_the_published_schema_is_the_one_that_lists_are_read_by() -> None:
    published = resources.files("kerfwise.apps.nesting") / "parts.schema.json"
    assert published.read_text(encoding="utf-8") == schema_text(), "run python -m kerfwise.apps.nesting.part_list"
    assert run("nest", "--schema").out == schema_text()


@pytest.mark.parametrize(
    ("text", "fine"),
    [
        (DAY.read_text(encoding="utf-8"), True),
        ("parts: [{part: a.dxf, rotations: any, grain: along}]", True),
        ("parts: [{part: a.dxf, rotations: 45}]\nsheets: [{size: 300x200, stock: 2}]", True),
        ("parts: [{quantity: 3}]", False),
        ("parts: [{part: a.dxf, quantity: 0}]", False),
        ("parts: [{part: a.dxf, colour: red}]", False),
        ("parts: [{part: a.dxf}]\nsheets: [{size: 300x200, file: a.json}]", False),
        ("sheets: [{size: 300x200}]", False),
    ],
)
def test_schema_and_reader_agree(text: str, fine: bool) -> None:
    assert VALIDATOR.is_valid(yaml.safe_load(text)) == fine
    if fine:
        assert list_of(text, "day.yaml").parts
    else:
        with pytest.raises(InputError):
            list_of(text, "day.yaml")
