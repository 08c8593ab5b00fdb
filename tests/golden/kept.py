"""Where the corpus is kept: for each case a file of what it means, and one of its texts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

MEANS, TEXTS = Path(__file__).parent / "kept", Path(__file__).parent / "texts"
LINE = 150
"""What is no longer than this as JSON stands on one line, and so does every cut."""


def read(name: str) -> tuple[dict[str, Any] | None, str | None]:
    """What is kept of a case, and its texts; None for what is not there."""
    means, texts = MEANS / f"{name}.json", TEXTS / f"{name}.txt"
    return (
        json.loads(means.read_text(encoding="utf-8")) if means.exists() else None,
        texts.read_text(encoding="utf-8") if texts.exists() else None,
    )


def write(name: str, means: dict[str, Any] | None = None, texts: str | None = None) -> None:
    """Keep what is given."""
    for folder, suffix, text in ((MEANS, "json", means and as_text(means) + "\n"), (TEXTS, "txt", texts)):
        if text is not None:
            folder.mkdir(exist_ok=True)
            (folder / f"{name}.{suffix}").write_text(text, encoding="utf-8", newline="\n")


def names() -> set[str]:
    """Of which cases anything is kept."""
    return {path.stem for path in (*MEANS.glob("*.json"), *TEXTS.glob("*.txt"))}


def remove(name: str) -> None:
    """Keep nothing of a case."""
    (MEANS / f"{name}.json").unlink(missing_ok=True)
    (TEXTS / f"{name}.txt").unlink(missing_ok=True)


def as_text(value: Any, indent: str = "") -> str:
    """JSON that can be read, and compared line by line."""
    line = json.dumps(value, ensure_ascii=False)
    short = not isinstance(value, dict | list) or len(line) <= LINE
    if short or not value or "contour" in value or "G1" in value or _flat(value):
        return json.dumps(value, ensure_ascii=False, separators=(",", ":")) if "contour" in line else line
    deeper = indent + " "
    if isinstance(value, dict):
        rows = [f"{json.dumps(k, ensure_ascii=False)}: {as_text(v, deeper)}" for k, v in value.items()]
    else:
        rows = [as_text(v, deeper) for v in value]
    left, right = "{}" if isinstance(value, dict) else "[]"
    return f"{left}\n{deeper}" + f",\n{deeper}".join(rows) + f"\n{indent}{right}"


def _flat(value: Any) -> bool:
    """Whether a list holds words or numbers only."""
    return isinstance(value, list) and not any(isinstance(of, dict | list) for of in value)
