"""How the house is built, in figures: files, lines, import circles, crumbs, long functions.

Usage: python benchmarks/house.py [ROOT] [--names] [--solve]

Read by `ast`, whatever modules are called. Product files are all Python files but those of tests, benchmarks and
examples; the core is all of them but those of `apps`. A circle counts imports within functions and those for types too.
With `--solve` one nest of 16 contours is planned in a process of its own, and the files and functions of kerfwise that
it runs through are counted (those compiled by numba are not). Test files that import nothing of kerfwise but its
interface (`kerfwise`, `cli`, `rule_kit`), other files of the tests and examples can stay as they are where rooms move.
A second figure leaves out those of them that reach a room by way of a helper or a benchmark. Words of prose are those
of README, CONTRIBUTING and docs, without code, tables, and the reference that is made of the code.
"""

from __future__ import annotations

import argparse
import ast
import os
import re
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ASIDE = {"tests", "benchmarks", "examples", "docs", "build", "dist"}
APPS = "apps"
PAGES = ("README.md", "CONTRIBUTING.md")
REFERENCE = {"api.md", "flattened.md", "profile.md", "rule-kit.md", "rules.md"}
"""Pages that commands make of the code."""
INTERFACE = {"kerfwise", "kerfwise.cli", "kerfwise.rule_kit", "kerfwise.api"}
BESIDE = ("tests", "benchmarks", "examples")
LARGEST_FILE, LONGEST_FUNCTION, MOST_PARAMETERS, MOST_IMPORTERS = 500, 60, 8, 60
NEST = Path(__file__).parents[1] / "examples" / "nests" / "e1x_6.json"
TRACED = """
import sys, threading, pathlib
ran = set()
def note(frame, event, arg):
    if event == "call":
        code = frame.f_code
        ran.add((code.co_filename, code.co_firstlineno, code.co_name))
threading.setprofile(note)
sys.setprofile(note)
try:
    from kerfwise.cli import main
    main(["solve", sys.argv[2], "--work", "1"])
except SystemExit as end:
    assert not end.code
sys.setprofile(None)
ours = {one for one in ran if one[0].startswith(sys.argv[1]) and not one[2].startswith("<")}
print(len({one[0] for one in ran if one[0].startswith(sys.argv[1])}), len(ours))
"""


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
    parameters: dict[str, int]
    """How many parameters they have but `self` and `cls`, by name."""


def main() -> None:
    """Read the tree and print its figures."""
    arguments = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    arguments.add_argument("root", nargs="?", type=Path, default=Path(__file__).parents[1])
    arguments.add_argument("--names", action="store_true", help="name files, circles, crumbs and functions, too")
    arguments.add_argument("--solve", action="store_true", help="plan a nest, and count what it runs through")
    given = arguments.parse_args()
    root = given.root.resolve()
    rows = [*figures(read(root)), *test_figures(root), *prose_figures(root)]
    rows += [("a solve of 16 contours: files, functions", ", ".join(traced(root)), [])] if given.solve else []
    for title, figure, names in rows:
        print(f"{title:52}{figure:>10}")
        if given.names:
            print("".join(f"    {name}\n" for name in names), end="")


def figures(modules: dict[str, Module]) -> Iterator[tuple[str, str, list[str]]]:
    """Each figure with its title, and the names behind it."""
    lines = [m.lines for m in modules.values()]
    yield "product files", f"{len(lines):,}", []
    yield "product lines", f"{sum(lines):,}", []
    for title, of_apps in (("core: files, lines", False), ("apps: files, lines", True)):
        some = [m.lines for name, m in modules.items() if (f".{APPS}." in f"{name}.") == of_apps]
        yield title, f"{len(some):,}, {sum(some):,}", []
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
    hubs = sorted(((len(by), name) for name, by in importers.items() if len(by) > MOST_IMPORTERS), reverse=True)
    names = [f"{name}: {count}" for count, name in hubs]
    yield f"modules with more than {MOST_IMPORTERS} importers", str(len(hubs)), names
    imports, code = sum(m.import_lines for m in modules.values()), sum(m.code_lines for m in modules.values())
    yield "import lines, share of lines of code", f"{imports / code:.1%}", []
    functions = {f"{m.name}:{name}": count for m in modules.values() for name, count in m.functions.items()}
    long = sorted((f for f in functions if functions[f] > LONGEST_FUNCTION), key=lambda f: -functions[f])
    yield (
        f"functions past {LONGEST_FUNCTION} lines, of {len(functions):,}",
        str(len(long)),
        [f"{f}: {functions[f]}" for f in long],
    )
    parameters = {f"{m.name}:{name}": count for m in modules.values() for name, count in m.parameters.items()}
    many = sorted((f for f in parameters if parameters[f] > MOST_PARAMETERS), key=lambda f: -parameters[f])
    yield (
        f"functions with more than {MOST_PARAMETERS} parameters",
        str(len(many)),
        [f"{f}: {parameters[f]}" for f in many],
    )


def test_figures(root: Path) -> Iterator[tuple[str, str, list[str]]]:
    """How many test files speak through the interface alone: by what they import, and with all helpers behind it."""
    package = "kerfwise"
    named: dict[str, set[str]] = {}
    for path in sorted(path for folder in BESIDE for path in (root / folder).rglob("*.py")):
        parts = path.relative_to(root).with_suffix("").parts
        name = ".".join((package, *(parts[:-1] if parts[-1] == "__init__" else parts)))
        within = name if parts[-1] == "__init__" else name.rpartition(".")[0]
        nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        found = (node for node in nodes if isinstance(node, ast.Import | ast.ImportFrom))
        named[name] = {to for node in found for to in _targets(node, within) if to.split(".")[0] == package}
    helpers = {name: {to for to in targets if to in named} for name, targets in named.items()}
    rooms = {path.stem for path in root.iterdir() if path.is_dir() or path.suffix == ".py"} - {"tests", "examples"}
    inner = {name for name, targets in named.items() if any(_is_inner(to, rooms) for to in targets)}
    tests = [name for name in named if name.rpartition(".")[2].startswith("test_")]
    for title, behind in (("by themselves", False), ("with their helpers", True)):
        outside = [name for name in tests if inner & ({name, *_reached(name, helpers)} if behind else {name})]
        figure = f"{len(tests) - len(outside)}"
        yield f"test files through the interface, of {len(tests)}, {title}", figure, outside


def _is_inner(target: str, rooms: set[str]) -> bool:
    """Whether an import names a room of the package that is no part of its interface, or something in one."""
    name = target.split(".")[1:2]
    return (
        bool(name)
        and name[0] in rooms
        and target not in INTERFACE
        and target.rpartition(".")[0] not in INTERFACE - {"kerfwise"}
    )


def _reached(name: str, helpers: dict[str, set[str]]) -> set[str]:
    """All files that a file imports, by way of others too."""
    found: set[str] = set()
    left = [name]
    while left:
        new = helpers[left.pop()] - found
        found |= new
        left += new
    return found


def prose_figures(root: Path) -> Iterator[tuple[str, str, list[str]]]:
    """Words of prose in README, CONTRIBUTING and docs: without code, tables and the pages that are made of the code."""
    words = {path.name: _prose(path.read_text(encoding="utf-8")) for path in (root / "docs").glob("*.md")}
    words |= {name: _prose((root / name).read_text(encoding="utf-8")) for name in PAGES if (root / name).exists()}
    pages = sorted(set(words) - REFERENCE, key=lambda name: (-words[name], name))
    if pages:
        named = [f"{name}: {words[name]:,}" for name in pages]
        yield f"words of prose on {len(pages)} pages", f"{sum(words[name] for name in pages):,}", named


def _prose(text: str) -> int:
    rows = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE).splitlines()
    return sum(len(row.split()) for row in rows if not row.lstrip().startswith("|"))


def traced(root: Path) -> tuple[str, str]:
    """Files and functions of kerfwise that a solve runs through."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-c", TRACED, str(root) + os.sep, str(NEST)]
        text = subprocess.run(command, cwd=folder, capture_output=True, encoding="utf-8", check=True).stdout
    files, functions = text.splitlines()[-1].split()
    return files, functions


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
    parameters: dict[str, int] = {}
    for node, loaded in _nodes(tree, True):
        if isinstance(node, ast.Import | ast.ImportFrom):
            import_rows.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
            for target in _targets(node, package):
                imports[target] = imports.get(target, False) or loaded
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            functions[f"{node.name}@{node.lineno}"] = (node.end_lineno or node.lineno) - node.lineno + 1
            every = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
            parameters[f"{node.name}@{node.lineno}"] = sum(one.arg not in ("self", "cls") for one in every)
    rows = text.splitlines()
    code = _code_rows(tree)
    return Module(name, is_package, len(rows), len(code), len(import_rows), imports, functions, parameters)


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
