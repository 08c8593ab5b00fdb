"""TypeScript's compiler, which checks the types that the page's modules state in their comments."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class MissingTypeScript(AssertionError):
    """TypeScript, or Node.js, is not on this machine: a test that needs it fails, and says how to get it."""


def compiler() -> tuple[str, ...]:
    """The command, without arguments: Node.js, and what npm fetched to $NODE_READERS, else to .tools/node."""
    script = Path(os.environ.get("NODE_READERS", ROOT / ".tools/node")) / "node_modules" / "typescript" / "bin" / "tsc"
    node = shutil.which("node")
    if node is None or not script.exists():
        raise MissingTypeScript(
            "TypeScript is missing: `sh tests/tools/get_node_readers.sh .tools/node` fetches it (needs Node.js)"
        )
    return node, str(script)
