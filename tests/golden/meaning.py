"""What the files and verdicts of a case mean, apart from how it is worded: plain values that are the same on every run.

Sentences, sha256, versions and seconds of computing are taken out. Sentences are handed back beside the rest.
"""

from __future__ import annotations

import csv
import hashlib
import json
import re
from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

DECIMALS = 3
"""Lengths to 0.001 mm, times to 0.001 s; what is less is written to six digits that count."""

LEFT_OUT = {"sha256", "file_sha256", "seconds", "version", "kerfwise", "memory_gb"}
SENTENCES = {"because", "why", "sentence", "title", "summary", "text", "description", "notes", "advice", "how"}
NAMES = {"id", "rule", "name", "contour", "part", "file", "excused", "contours"}
LARGEST = 6000
"""JSON of more characters than this under one key is kept as a digest, unless it holds cuts."""

Texts = list[str]


def of_file(path: Path, texts: Texts) -> Any:
    """What a file means; its sentences are added to `texts`."""
    read = _READERS.get(path.suffix)
    if path.name.startswith("ordered") and path.suffix == ".svg":
        return of_drawing(path, texts)
    return "there" if read is None else read(path, texts)


KEPT = ("kept", {"kind": "kept", "count": 0, "places": []})
"""The state of a plan without exceptions: only others are kept here."""


def of_json(path: Path, texts: Texts) -> Any:
    """A JSON file: a plan with all its cuts, anything else in so far as it is short."""
    held = json.loads(path.read_text(encoding="utf-8"))
    kept = of_value(held, texts)
    if isinstance(held, dict) and str(held.get("format", "")).startswith("kerfwise-plan/"):
        for cut in [*kept["cuts"], *kept.get("already_cut", [])]:
            _without_repeats(cut)
        kept["rules"] = by_verdict({row["id"]: _rule(row) for row in kept["rules"]})
        return kept
    return _short(kept)


def of_printed(text: str, texts: Texts) -> Any:
    """JSON that a command printed."""
    return _short(of_value(json.loads(text), texts))


def of_value(value: Any, texts: Texts, path: str = "") -> Any:
    """A value of a JSON file, rounded, without sentences and what is not the same on every run."""
    if isinstance(value, dict):
        kept = {}
        for key, of in value.items():
            if key in LEFT_OUT or (key == "state" and of in KEPT):
                continue
            where = f"{path}.{key}" if path else key
            if key in SENTENCES or (key not in NAMES and isinstance(of, str) and len(of.split()) > 3):
                texts.extend(f"{where}: {line}" for line in ([of] if isinstance(of, str) else _lines(of)))
            else:
                kept[key] = of_value(of, texts, where)
        return kept
    if isinstance(value, list):
        return [of_value(of, texts, f"{path}[{_name(k, of)}]") for k, of in enumerate(value)]
    return rounded(value)


def rounded(value: Any) -> Any:
    """A number to 0.001, to six digits where that says more; a text without this folder's path and without hashes."""
    if isinstance(value, str):
        return re.sub(r"\b[0-9a-f]{64}\b", "#", value.replace(str(Path.cwd()), "."))
    if not isinstance(value, float):
        return value
    short = round(value, DECIMALS)
    if abs(short) < 1 and value:
        short = float(f"{value:.6g}") if abs(value) > 1e-9 else 0.0
    return int(short) if short == int(short) and abs(short) < 1e15 else short


def of_program(path: Path, texts: Texts) -> dict[str, Any]:
    """An NC program without its comments: how many lines, of which words, and their digest."""
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    texts.extend(f"comment: {line}" for line in lines if line.startswith(("(", ";")))
    bare = [line for line in (re.sub(r"\([^)]*\)|;.*", "", line).strip() for line in lines) if line]
    words = Counter(f"{a}{int(b)}" for line in bare for a, b in re.findall(r"([GMTS])(\d+)(?![\d.])", line))
    return {"lines": len(bare), "words": dict(sorted(words.items())), "digest": digest("\n".join(bare))}


def of_dxf(path: Path, texts: Texts) -> dict[str, Any]:
    """A DXF drawing: entities of each kind and layer, in order."""
    rows = [line.strip() for line in path.read_text(encoding="utf-8").splitlines()]
    pairs = list(zip(rows[::2], rows[1::2], strict=False))
    start = next((k for k, pair in enumerate(pairs) if pair == ("2", "ENTITIES")), 0)
    body = [(c, _number(v)) for c, v in pairs[start:] if c not in ("5", "330", "100", "102", "360")]
    kinds = Counter(v for c, v in body if c == "0")
    return {"entities": dict(sorted(kinds.items())), "digest": digest(json.dumps(body))}


def of_drawing(path: Path, texts: Texts) -> dict[str, Any]:
    """An SVG that a machine will cut: its shapes in order."""
    shapes = re.findall(r"<(path|circle|rect|ellipse|line|poly\w+)\b([^>]*)>", path.read_text(encoding="utf-8"))
    return {
        "shapes": dict(sorted(Counter(tag for tag, _ in shapes).items())),
        "digest": digest(json.dumps([[tag, " ".join(rest.split())] for tag, rest in shapes])),
    }


def of_table(path: Path, texts: Texts) -> list[list[str]]:
    """A CSV table, without columns of seconds and hashes, and without sentences."""
    rows = list(csv.reader(path.read_text(encoding="utf-8").splitlines()))
    head = rows[0] if rows else []
    wanted = [k for k, name in enumerate(head) if name not in LEFT_OUT]
    texts.extend(row[k] for row in rows for k in wanted if k < len(row) and len(row[k].split()) > 3)
    return [[rounded(row[k]) for k in wanted if k < len(row) and len(row[k].split()) <= 3] for row in rows]


def of_whole(path: Path, texts: Texts) -> dict[str, Any]:
    """A file of which every character counts, such as data for MiniZinc."""
    text = re.sub(r"\b[0-9a-f]{12,64}\b", "#", path.read_text(encoding="utf-8"))
    return {"lines": len(text.splitlines()), "digest": digest(text)}


def digest(text: str) -> str:
    """Sixteen digits that change with any character."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def verdicts(result: Any) -> dict[str, Any]:
    """What `kerfwise.check` says of each rule: strength, verdict, and the contours where it is broken or excused."""
    rows = {}
    for rule in result.rules:
        places = [*rule.violations, *(e.violation for e in rule.excused)]
        at = "; ".join(" ".join(one.contours) for one in places)
        rows[rule.id] = f"{rule.strength} {rule.verdict}" + (f" {len(places)}: {at}" if places else "")
    measured = result.measured
    return {
        "ok": result.ok,
        "rules": by_verdict(rows),
        "measured": {"paths": measured.paths, "on_mm": rounded(measured.on_mm), "idle_mm": rounded(measured.idle_mm)},
    }


def _without_repeats(cut: dict[str, Any]) -> None:
    """Take out of a row what the rest of it says: part and kind, a lead's pierce, a lead-out that goes nowhere."""
    del cut["part"], cut["kind"]
    if cut.get("lead_in") and cut["lead_in"][0][:2] == cut["pierce"]:
        del cut["lead_in"][0]
    if len(cut.get("lead_out", ())) == 1:
        del cut["lead_out"]


def by_verdict(rows: dict[str, str]) -> dict[str, list[str]]:
    """The names of rules under what is said of them."""
    found: dict[str, list[str]] = {}
    for name, said in rows.items():
        found.setdefault(said, []).append(name)
    return found


def _rule(row: dict[str, Any]) -> str:
    """A rule's row of a plan in one line: its strength, whether it holds, and where it does not."""
    said = f"{row['strength']} {'holds' if row['holds'] else 'broken'}"
    for key in ("exceptions", "breaches"):
        if row.get(key):
            said += f", {len(row[key])} {key}: " + "; ".join(" ".join(one["contours"]) for one in row[key])
    more = {k: v for k, v in row.items() if k not in ("id", "strength", "holds", "exceptions", "breaches")}
    return said + (f" {json.dumps(more)}" if more else "")


def _short(value: Any) -> Any:
    """The value, with a digest in the place of all that is long."""
    if isinstance(value, dict):
        return {key: _short_one(of) for key, of in value.items()}
    return _short_one(value)


def _short_one(value: Any) -> Any:
    text = json.dumps(value)
    return value if len(text) <= LARGEST else {"entries": len(value), "digest": digest(text)}


def _lines(value: Any) -> Iterable[str]:
    return value if isinstance(value, list) and all(isinstance(v, str) for v in value) else [json.dumps(value)]


def _name(place: int, value: Any) -> str:
    named = (value.get(key) for key in ("contour", "id", "rule")) if isinstance(value, dict) else ()
    return str(next((v for v in named if v is not None), place))


def _number(text: str) -> Any:
    try:
        return rounded(float(text))
    except ValueError:
        return text


_READERS: dict[str, Callable[[Path, Texts], Any]] = {
    ".json": of_json,
    ".dxf": of_dxf,
    ".csv": of_table,
    ".dzn": of_whole,
    ".yaml": of_whole,
    **dict.fromkeys((".nc", ".ngc", ".cnc", ".esi", ".gcode", ".mpf"), of_program),
}
