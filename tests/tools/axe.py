"""axe-core, which looks for what keeps people from using a page: names that are missing, contrast, roles, order."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

from playwright.sync_api import Page

ROOT = Path(__file__).resolve().parents[2]


class MissingAxe(AssertionError):
    """axe-core is not on this machine: a test that needs it fails, and says how to get it."""


@cache
def _script() -> str:
    """Its text, as npm fetched it to $NODE_READERS, else to .tools/node."""
    path = Path(os.environ.get("NODE_READERS", ROOT / ".tools/node")) / "node_modules" / "axe-core" / "axe.min.js"
    if not path.exists():
        raise MissingAxe("axe-core is missing: `sh tests/tools/get_node_readers.sh .tools/node` fetches it")
    return path.read_text(encoding="utf-8")


def findings(page: Page) -> list[str]:
    """What axe finds on the page as it stands: the rule, what it says, and where, a line each."""
    if not page.evaluate("'axe' in window"):
        page.evaluate(f"() => {{ {_script()} }}")
    told = page.evaluate("axe.run(document, { resultTypes: ['violations'] }).then(found => found.violations)")
    return [
        f"{one['id']}: {one['help']}: {node['target'][0]}: {node.get('failureSummary', '').splitlines()[-1].strip()}"
        for one in told
        for node in one["nodes"]
    ]
