"""Where in a JSON text a value stands, for messages."""

from __future__ import annotations

from collections.abc import Sequence

import yaml

Path = Sequence[str | int]
_ONE_OF = {"holes": "hole", "marks": "mark", "scrap": "scrap line", "tabs": "tab", "bridges": "bridge"}


def places(text: str, paths: Sequence[Path]) -> list[tuple[int | None, int | None]]:
    """Line and column, counted from 1, of the values that paths of keys and indices lead to.

    JSON is YAML, and a YAML parser keeps the positions. (None, None) where the text is one it does not follow.

    Examples
    --------
    >>> places('{"parts": [\\n  {"id": "A"},\\n  {"id": 7}]}', [["parts", 1, "id"]])
    [(3, 10)]
    """
    if not paths:
        return []
    try:
        root = yaml.compose(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    except (yaml.YAMLError, RecursionError):
        root = None
    return [_place(root, path) for path in paths]


def _place(node: yaml.Node | None, path: Path) -> tuple[int | None, int | None]:
    if node is None:
        return None, None
    for step in path:
        if isinstance(node, yaml.MappingNode):
            node = next((value for key, value in node.value if key.value == step), node)
        elif isinstance(node, yaml.SequenceNode) and isinstance(step, int) and step < len(node.value):
            node = node.value[step]
    return node.start_mark.line + 1, node.start_mark.column + 1


def spoken(path: Path, part_ids: Sequence[object]) -> str:
    """A path in words: "part 'P3', hole 2, vertex 5".

    Examples
    --------
    >>> spoken(["parts", 2, "holes", 1, 4, 0], ["P1", "P2", "P3"])
    "part 'P3', hole 2, vertex 5, x"
    """
    words, steps = [], list(path)
    if len(steps) > 1 and steps[0] == "parts" and isinstance(steps[1], int):
        name = part_ids[steps[1]] if steps[1] < len(part_ids) else None
        words.append(f"part '{name}'" if isinstance(name, str) and name else f"part number {steps[1] + 1}")
        steps = steps[2:]
    elif steps and steps[0] == "sheet":
        words.append("the sheet")
        steps = steps[1:]
    if len(steps) > 1 and steps[0] in _ONE_OF and isinstance(steps[1], int):
        words.append(f"{_ONE_OF[str(steps[0])]} {steps[1] + 1}")
        steps = steps[2:]
    elif steps:
        words.append(f"{steps[0]}")
        steps = steps[1:]
    if steps and steps[0] in ("at", "width", "parts", "from", "to"):
        return ", ".join([*words, str(steps[0])])
    if steps and isinstance(steps[0], int):
        words.append(f"vertex {steps[0] + 1}")
        steps = steps[1:]
    if steps and isinstance(steps[0], int):
        words.append(("x", "y", "bulge")[min(steps[0], 2)])
    return ", ".join(words) or "the file"
