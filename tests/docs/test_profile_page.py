"""The page of every key of a profile is made from what profiles are read with."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.docs.profile_page import profile_page


def keys_of(schema: dict[str, Any], path: str = "") -> Iterator[str]:
    """Every key that the schema allows, as the page names it under its heading."""
    for key, inner in schema.get("properties", {}).items():
        rule = (one for one in inner.get("anyOf", ()) if "strength" in one.get("properties", ()))
        mapping = inner if "properties" in inner else next(rule, None)  # other mappings are values of one key
        if mapping is not None:
            yield from keys_of(mapping, f"{path}{key}.")
        elif not inner.get("deprecated"):
            yield f"{path}{key}"


def test_docs_are_up_to_date() -> None:
    written = Path(__file__).parents[2] / "docs" / "profile.md"
    made = "run python -m kerfwise.tests.docs.profile_page > profile.md && mv profile.md docs/profile.md"
    assert written.read_text(encoding="utf-8") == profile_page(), made


def test_every_key_of_the_schema_is_on_the_page() -> None:
    schema = json.loads(kerfwise("profile", "schema").out)
    parts = {part.split("\n")[0]: part for part in profile_page().split("\n## ")}
    for section, inner in schema["properties"].items():
        if section not in parts:
            assert f"| `{section}` |" in parts["At the top"]
            continue
        entry = inner.get("items", {})
        in_lists = [key for one in (entry, *entry.get("oneOf", ())) for key in one.get("properties", ())]
        keys = in_lists or list(keys_of(inner))
        assert keys
        missing = [key for key in keys if f"| `{key}` |" not in parts[section]]
        assert not missing, f"{section}: {missing}"


def test_no_cell_ends_a_row_early() -> None:
    for line in profile_page().splitlines():
        if line.startswith("|"):
            assert line.replace("\\|", "").count("|") in (3, 4, 5), line
