"""How the house is built, in figures: files, lines, import circles, crumbs, long functions.

Usage: python benchmarks/house.py [ROOT] [--names]

Read by `ast`, whatever modules are called. Product files are all Python files but those of tests, benchmarks and
examples. A circle counts imports within functions and those for types too.
"""

from __future__ import annotations

import argparse
import ast
import statistics
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ASIDE = {"tests", "benchmarks", "examples", "docs", "build", "dist"}
LARGEST_FILE, LONGEST_FUNCTION = 500, 60


@dataclass(frozen=True)
class Module:
    """A product file: its lines, how many of its code are imports, what it imports and when, and its functions."""

    name: str
    is_package: bool
    lines: int
    code_lines: int
    import_lines: int
    imports: dict[str, bool]
    """Names that are imported; True if while the module is loaded."""
    functions: dict[str, int]
    """Their lines, by name."""


def main() -> None:
    """Read the tree and print its figures."""
    arguments = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    arguments.add_argument("root", nargs="?", type=Path, default=Path(__file__).parents[1])
    arguments.add_argument("--names", action="store_true", help="name files, circles, crumbs and functions, too")
    given = arguments.parse_args()
    modules = read(given.root.resolve())
    for title, figure, names in figures(modules):
        print(f"{title:52}{figure:>10}")
        if given.names:
            print("".join(f"    {name}\n" for name in names), end="")


def figures(modules: dict[str, Module]) -> Iterator[tuple[str, str, list[str]]]:
    """Each figure with its title, and the names behind it."""
    lines = [m.lines for m in modules.values()]
    yield "product files", f"{len(lines):,}", []
    yield "product lines", f"{sum(lines):,}", []
    yield "median lines of a file", f"{statistics.median(lines):g}", []
    large = sorted((m for m in modules.values() if m.lines > LARGEST_FILE), key=lambda m: -m.lines)
    yield f"files past {LARGEST_FILE} lines", str(len(large)), [f"{m.name}: {m.lines}" for m in large]
    loaded, every = edges(modules, loaded=True), edges(modules, loaded=False)
    for title, graph in (("circles of imports at load", loaded), ("circles, with lazy and typing imports", every)):
        found = circles(graph)
        held = sum(map(len, found))
        yield f"{title} (files in them)", f"{len(found)} ({held})", [" · ".join(sorted(one)) for one in found]
    importers = {name: {m for m, to in every.items() if name in to} for name in modules}
    once = {name: next(iter(by)) for name, by in importers.items() if len(by) == 1 and not modules[name].is_package}
    near = sum(name.rpartition(".")[0] == by.rpartition(".")[0] for name, by in once.items())
    yield (
        "modules with exactly one importer (same folder)",
        f"{len(once)} ({near})",
        [f"{a} ← {b}" for a, b in once.items()],
    )
    imports, code = sum(m.import_lines for m in modules.values()), sum(m.code_lines for m in modules.values())
    yield "import lines, share of lines of code", f"{imports / code:.1%}", []
    functions = {f"{m.name}:{name}": count for m in modules.values() for name, count in m.functions.items()}
    long = sorted((f for f in functions if functions[f] > LONGEST_FUNCTION), key=lambda f: -functions[f])
    yield (
        f"functions past {LONGEST_FUNCTION} lines, of {len(functions):,}",
        str(len(long)),
        [f"{f}: {functions[f]}" for f in long],
    )


def read(root: Path) -> dict[str, Module]:
    """The product's modules by their dotted names, of which the first is the root's folder."""
    found = {}
    for path in sorted(root.rglob("*.py")):
        parts = path.relative_to(root).with_suffix("").parts
        if parts[0] in ASIDE or any(part.startswith(".") for part in parts):
            continue
        is_package = parts[-1] == "__init__"
        name = ".".join((root.name, *(parts[:-1] if is_package else parts)))
        found[name] = _module(name, is_package, path.read_text(encoding="utf-8"))
    return found


def _module(name: str, is_package: bool, text: str) -> Module:
    tree = ast.parse(text)
    package = name if is_package else name.rpartition(".")[0]
    imports: dict[str, bool] = {}
    import_rows: set[int] = set()
    functions: dict[str, int] = {}
    for node, loaded in _nodes(tree, True):
        if isinstance(node, ast.Import | ast.ImportFrom):
            import_rows.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
            for target in _targets(node, package):
                imports[target] = imports.get(target, False) or loaded
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            functions[f"{node.name}@{node.lineno}"] = (node.end_lineno or node.lineno) - node.lineno + 1
    rows = text.splitlines()
    code = _code_rows(tree)
    return Module(name, is_package, len(rows), len(code), len(import_rows), imports, functions)


def _nodes(node: ast.AST, loaded: bool) -> Iterator[tuple[ast.AST, bool]]:
    """All nodes below, and whether each is run while the module is loaded."""
    typing_only = node.body if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test) else []
    later = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
    for child in ast.iter_child_nodes(node):
        now = loaded and not later and child not in typing_only
        yield child, now
        yield from _nodes(child, now)


def _targets(node: ast.Import | ast.ImportFrom, package: str) -> Iterator[str]:
    """The dotted names that an import could mean, modules and what is in them."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
        return
    base = node.module or ""
    if node.level:
        parent = package.split(".")[: len(package.split(".")) - node.level + 1]
        base = ".".join([*parent, *([base] if base else [])])
    yield base
    yield from (f"{base}.{alias.name}" for alias in node.names)


def _code_rows(tree: ast.Module) -> set[int]:
    """Rows that hold a statement which is no docstring."""
    rows: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.expr) or (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)):
            continue
        if isinstance(node, ast.stmt):
            body = getattr(node, "body", None)
            last = body[0].lineno - 1 if isinstance(body, list) and body else (node.end_lineno or node.lineno)
            rows.update(range(node.lineno, max(last, node.lineno) + 1))
    return rows


def edges(modules: dict[str, Module], loaded: bool) -> dict[str, set[str]]:
    """Which modules of the product each module imports; with `loaded` only while it is loaded itself."""
    graph: dict[str, set[str]] = {}
    for name, module in modules.items():
        wanted = {target for target, at_load in module.imports.items() if at_load or not loaded}
        named = {target for target in wanted if target in modules}
        named -= {t for t in named if modules[t].is_package and any(other.startswith(f"{t}.") for other in named)}
        graph[name] = named - {name}
    return graph


def circles(graph: dict[str, set[str]]) -> list[set[str]]:
    """Groups of modules that import each other, by way of others too (Tarjan's strongly connected components)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[set[str]] = []
    for start in graph:
        if start in index:
            continue
        work = [(start, iter(sorted(graph[start])))]
        index[start] = low[start] = len(index)
        stack.append(start)
        while work:
            name, rest = work[-1]
            following = next(rest, None)
            if following is None:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[name])
                if low[name] == index[name]:
                    group = set(stack[stack.index(name) :])
                    del stack[stack.index(name) :]
                    found += [group] if len(group) > 1 else []
            elif following not in index:
                index[following] = low[following] = len(index)
                stack.append(following)
                work.append((following, iter(sorted(graph[following]))))
            elif following in stack:
                low[name] = min(low[name], index[following])
    return found


if __name__ == "__main__":
    main()
