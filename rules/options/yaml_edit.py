"""One value of a YAML text set, or taken out, with all else as it is: comments, order and spacing."""

from __future__ import annotations

from collections.abc import Sequence

import yaml

from .yaml_positions import compose, is_empty


def with_value(text: str, path: Sequence[str], value: str) -> str:
    """The text with `value`, as YAML, under the keys of `path`; keys that are missing are added.

    Raises
    ------
    InputError
        If the text is not YAML.

    Examples
    --------
    >>> print(with_value("material:\\n  kerf: 1.5 mm  # wide\\n", ["material", "kerf"], "2 mm"), end="")
    material:
      kerf: 2 mm  # wide
    >>> with_value("material: {kerf: 1.5 mm}\\n", ["material", "thickness"], "8 mm")
    'material: {thickness: 8 mm, kerf: 1.5 mm}\\n'
    """
    node, begins = compose(text, ""), 0
    for depth, key in enumerate(path):
        if not isinstance(node, yaml.MappingNode) or not node.value:
            return _begun(text, node, begins, path[depth:], value, depth)
        found = next(((at, inner) for at, inner in node.value if at.value == key), None)
        if found is None:
            return _added(text, node, path[depth:], value)
        begins, node = text.index(":", found[0].end_mark.index) + 1, found[1]
    assert node is not None
    return _replaced(text, node, begins, value)


def without_value(text: str, path: Sequence[str]) -> str:
    """The text without the last key of `path`, and without what stood there; a mapping that is then empty goes too.

    Nothing is changed where there is no such key.

    Raises
    ------
    InputError
        If the text is not YAML.

    Examples
    --------
    >>> without_value("material: {kerf: 1.5 mm, thickness: 8 mm}  # plate\\n", ["material", "thickness"])
    'material: {kerf: 1.5 mm}  # plate\\n'
    >>> without_value("material:\\n  kerf: 1.5 mm  # wide\\nname: plant\\n", ["material", "kerf"])
    'name: plant\\n'
    """
    node = compose(text, "")
    found: tuple[yaml.MappingNode, int] | None = None
    for key in path:
        if not isinstance(node, yaml.MappingNode):
            return text
        at = next((k for k, (name, _) in enumerate(node.value) if name.value == key), None)
        if at is None:
            return text
        if found is None or len(node.value) > 1:
            found = node, at
        node = node.value[at][1]
    return text if found is None else _cut_out(text, *found)


def _cut_out(text: str, node: yaml.MappingNode, at: int) -> str:
    """Without one entry of a mapping; in a block, without the rest of its last line too."""
    key, value = node.value[at]
    if not node.flow_style:
        line = text.rfind("\n", 0, key.start_mark.index) + 1
        ends = text.find("\n", max(_end(value), key.end_mark.index))
        return text[:line] + (text[ends + 1 :] if ends >= 0 else "")
    if at:
        return text[: _end(node.value[at - 1][1])] + text[_end(value) :]
    after = node.value[1][0].start_mark.index if len(node.value) > 1 else _end(value)
    return text[: key.start_mark.index] + text[after:]


def _replaced(text: str, node: yaml.Node, begins: int, value: str) -> str:
    """Another value after the colon of its key, at `begins`; comments between that and a block stay."""
    between = text[begins : node.start_mark.index]
    line, newline, _ = between.partition("\n")
    kept = f"  {line.strip()}" if newline and line.strip() else ""
    return f"{text[:begins]} {value}{kept}{text[_end(node) :]}"


def _end(node: yaml.Node) -> int:
    """Where the last word of a value ends; PyYAML lets a block end where the next one begins."""
    while isinstance(node, yaml.CollectionNode) and not node.flow_style and node.value:
        last = node.value[-1]
        node = last[1] if isinstance(node, yaml.MappingNode) else last
    return node.end_mark.index


def _added(text: str, node: yaml.MappingNode, path: Sequence[str], value: str) -> str:
    """The key before the first one of a mapping; at the end of the text where that is the whole."""
    if node.flow_style:
        at = node.start_mark.index + 1
        return f"{text[:at]}{_flow(path, value)}, {text[at:]}"
    first = node.value[0][0].start_mark
    if first.column == 0:
        return f"{text.rstrip()}\n\n{_block(path, value, 0)}\n"
    line = first.index - first.column
    return f"{text[:line]}{_block(path, value, first.column)}\n{text[line:]}"


def _begun(text: str, node: yaml.Node | None, begins: int, path: Sequence[str], value: str, depth: int) -> str:
    """The first key under one that has none yet, or of an empty text."""
    if node is None or is_empty(node):
        at = len(text.rstrip()) if node is None else node.start_mark.index
        start = "" if node is None and not text.strip() else "\n"
        return f"{text[:at]}{start}{_block(path, value, 2 * depth)}{text[at:] or chr(10)}"
    return _replaced(text, node, begins, f"{{{_flow(path, value)}}}")


def _flow(path: Sequence[str], value: str) -> str:
    *outer, last = path
    return "".join(f"{key}: {{" for key in outer) + f"{last}: {value}" + "}" * len(outer)


def _block(path: Sequence[str], value: str, indent: int) -> str:
    *outer, last = path
    lines = [f"{' ' * (indent + 2 * k)}{key}:" for k, key in enumerate(outer)]
    return "\n".join([*lines, f"{' ' * (indent + 2 * len(outer))}{last}: {value}"])
