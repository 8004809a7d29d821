"""Fail where folders of the C++ library or modules of the Python package need one another.

    scripts/check_circles.py

Data goes one way (docs/architecture.md), and so do includes and imports. A file directly in
``include/der/`` or ``src/`` counts as a folder of its own. Imports for type checking count too.
The page has to be true: folders include one another in its order, and the files that it names
exist.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LIBRARY = (ROOT / "cpp/include/der", ROOT / "cpp/src")
PACKAGE = ROOT / "python/der"
PAGE = ROOT / "docs/architecture.md"

Graph = dict[str, set[str]]


def folder_of(path: str) -> str:
    """Return the folder of a file below ``include/der`` or ``src``."""
    first, *rest = path.split("/")
    return first if rest else Path(first).stem


def include_graph() -> Graph:
    """Return which folder of the library includes headers of which others."""
    graph: Graph = {}
    for root in LIBRARY:
        for file in (*root.rglob("*.hpp"), *root.rglob("*.cpp")):
            folder = folder_of(file.relative_to(root).as_posix())
            for header in re.findall(r'^#include "(?:der/)?(.+)"', file.read_text(), re.MULTILINE):
                if folder_of(header) != folder:
                    graph.setdefault(folder, set()).add(folder_of(header))
    return graph


def imported_names(file: Path) -> Iterator[str]:
    """Yield every module, or name of a module, that a file imports."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def import_graph() -> Graph:
    """Return which module of the package imports which others."""
    modules = {
        ".".join(("der", *file.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(
            ".__init__"
        ): file
        for file in PACKAGE.rglob("*.py*")
        if file.suffix in (".py", ".pyi")
    }
    graph: Graph = {}
    for module, file in modules.items():
        for name in imported_names(file):
            # A name that is imported from a module may be a module itself.
            target = name if name in modules else name.rpartition(".")[0]
            if target in modules and target != module:
                graph.setdefault(module, set()).add(target)
    return graph


def reached_from(start: str, graph: Graph) -> set[str]:
    """Return everything that `start` needs, also by way of others."""
    reached: set[str] = set()
    waiting = [start]
    while waiting:
        new = graph.get(waiting.pop(), set()) - reached
        reached |= new
        waiting += new
    return reached


def circles(graph: Graph) -> list[list[str]]:
    """Return the groups in which each member needs all others."""
    reached = {node: reached_from(node, graph) for node in graph}
    groups = {
        frozenset(other for other in reached[node] if node in reached.get(other, ()))
        for node in graph
        if node in reached[node]
    }
    return sorted(sorted(group) for group in groups)


def stated_order(page: str) -> list[str]:
    """Return the folders of the library in the order in which the page lists them."""
    sentence = re.search(r"each includes some of those before it in\s([^.]+)\.", page)
    if sentence is None:
        raise SystemExit(f"{PAGE.name} no longer says in which order folders include one another")
    return re.findall(r"`(\w+)`", sentence.group(1))


def against_order(graph: Graph, order: list[str]) -> Iterator[str]:
    """Yield what the page's order of folders does not allow, and folders that it lacks."""
    folders = {folder.name for root in LIBRARY for folder in root.iterdir() if folder.is_dir()}
    for folder in sorted(folders.symmetric_difference(order)):
        yield f"'{folder}' is a folder of the library or in the order of the page, not both"
    place = {folder: i for i, folder in enumerate(order)}
    for folder, included in sorted(graph.items()):
        for other in sorted(included & place.keys()):
            if folder in place and place[other] > place[folder]:
                yield f"'{folder}' includes '{other}', which comes after it on the page"


def missing_files(page: str) -> Iterator[str]:
    """Yield the files that the page names and that do not exist."""
    roots = (
        "cpp",
        "bindings",
        "python",
        "tests",
        "benchmarks",
        "docs",
        "scripts",
        "configs",
        "examples",
    )
    files = [
        "/" + file.relative_to(ROOT).as_posix()
        for root in roots
        for file in (ROOT / root).rglob("*.*")
    ]
    for name in sorted(set(re.findall(r"`([a-z0-9_/.]+\.(?:hpp|cpp|py|md))`", page))):
        if not any(file.endswith("/" + name) for file in files):
            yield f"the page names '{name}', which does not exist"


def main() -> int:
    """Print the circles found, and what the page says wrongly; return the exit code."""
    page = PAGE.read_text(encoding="utf-8")
    found = 0
    for kind, graph in (("folders", include_graph()), ("modules", import_graph())):
        for circle in circles(graph):
            print(f"{kind} that need one another:")
            for member in circle:
                print(f"  {member} needs {', '.join(sorted(graph[member] & set(circle)))}")
            found += 1
    for error in (*against_order(include_graph(), stated_order(page)), *missing_files(page)):
        print(f"{PAGE.name}: {error}")
        found += 1
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
