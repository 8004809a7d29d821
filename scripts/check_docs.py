"""Run every command and snippet of the README and of docs/, so that none of them can rot.

Usage: ``python scripts/check_docs.py [PAGE...]`` (default: all pages). The blocks of a page run one
after the other in a temporary folder that holds links to the folders of the checkout; pages run
side by side. A block is treated as follows:

- ``sh``: run by bash with the environment's programs first on the PATH;
- ``python``: run in one interpreter for the page, so that later blocks know the names of earlier
  ones;
- ``yaml``: a complete scene is validated, and saved under the name that the text before it gives
  ("Save this as `swing.yaml`"), so that later blocks can run it. A part of a scene replaces that
  part of a small one; where a key stands twice, each is tried on its own.

On the line above a block ``<!-- no-test: REASON -->`` leaves it out, ``<!-- exit-code: N -->`` says
that a command ends with that code.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
TIMEOUT_SECONDS = 600
LANGUAGES = ("sh", "python", "yaml")
# The folders that a page may refer to, relative to the root of the checkout.
LINKED = ("benchmarks", "configs", "docs", "tests")
FENCE = re.compile(
    r"^(?P<indent> *)```(?P<language>\w+)[^\n]*\n(?P<code>.*?)^ *```\s*$",
    flags=re.MULTILINE | re.DOTALL,
)
MARK = re.compile(r"<!-- (?P<word>no-test|exit-code)(?:: (?P<value>[^>]*?))? -->\s*\Z")
SAVED_AS = re.compile(r"[Ss]ave (?:this|it) as `([\w.-]+)`[^`]*\Z")
TOP_KEY = re.compile(r"^(\w+):", flags=re.MULTILINE)

# The scene in which examples of parts of scenes are checked: their keys replace its own.
BASE_SCENE = {
    "title": "title: A small cantilever\n",
    "rods": """rods:
  - name: rod
    nodes: 11
    from: [0, 0]
    to: [1, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, density: 1000}
""",
    "supports": "supports: [{rod: rod, at: start, clamp: true}]\n",
    "loads": "loads: [{gravity: [0, -9.81]}]\n",
    "time": "time: {duration: 1, step: 0.01}\n",
}


@dataclass(frozen=True)
class Block:
    """A fenced block of a page: its place (1-based line), language and code."""

    page: Path
    line: int
    language: str
    code: str
    saved_as: str = ""
    exit_code: int = 0
    left_out: str = ""

    def __str__(self) -> str:
        """Return the place of the block."""
        page = self.page.relative_to(ROOT) if self.page.is_relative_to(ROOT) else self.page
        return f"{page}:{self.line}: {self.language}"


class Failure(Exception):
    """A block does not do what it should; the message is its output."""


def pages() -> list[Path]:
    """Return every page that people read."""
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(page: Path) -> Iterator[Block]:
    """Yield the blocks of a page in languages that can be run, in order."""
    text = page.read_text(encoding="utf-8")
    for match in FENCE.finditer(text):
        if match["language"] not in LANGUAGES:
            continue
        before = text[: match.start()].rstrip()
        line = text.count("\n", 0, match.start()) + 1
        marks: dict[str, Any] = {}
        if mark := MARK.search(before):
            before = before[: mark.start()].rstrip()
            value = (mark["value"] or "").strip()
            if mark["word"] == "exit-code":
                marks["exit_code"] = int(value)
            elif not value:
                raise SystemExit(f"{page}:{line - 1}: say why: <!-- no-test: REASON -->")
            else:
                marks["left_out"] = value
        if name := SAVED_AS.search(before):
            marks["saved_as"] = name[1]
        code = re.sub(rf"^{match['indent']}", "", match["code"], flags=re.MULTILINE)
        yield Block(page, line, match["language"], code, **marks)


def run_shell(block: Block) -> None:
    """Run the commands of a block in the present folder."""
    own = ROOT / ".venv"
    if re.search(r"^scripts/", block.code, flags=re.MULTILINE) and Path(sys.prefix) != own:
        print(f"  not run: it sets up {own}, and this is {sys.prefix}")
        return
    run = subprocess.run(
        ["bash", "-eu", "-o", "pipefail", "-c", block.code],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
        text=True,
    )
    if run.returncode != block.exit_code:
        raise Failure(f"exit code {run.returncode} and not {block.exit_code}\n{run.stdout}")


def run_python(block: Block, names: dict[str, Any]) -> None:
    """Run the code of a block among the names of the blocks before it."""
    # The line numbers of an error are those of the page.
    source = "\n" * block.line + block.code
    # A reader's interpreter has none of the future statements of this file.
    code = compile(source, str(block.page), "exec", dont_inherit=True)
    exec(code, names)


def variants(fragment: str) -> Iterator[str]:
    """Yield scenes with the top-level keys of `fragment` in them; a key given twice makes two."""
    starts = [match.start() for match in TOP_KEY.finditer(fragment)]
    if not starts:
        raise Failure("neither a scene nor top-level keys of one: mark it with a reason")
    parts = [fragment[a:b] for a, b in zip(starts, [*starts[1:], None], strict=True)]
    scene: dict[str, str] = {}
    for part in parts:
        key = part.partition(":")[0]
        if key in scene:
            yield merged(scene)
            scene = {}
        scene[key] = part
    yield merged(scene)


def merged(keys: dict[str, str]) -> str:
    """Return the base scene with some of its top-level keys replaced."""
    base = dict(BASE_SCENE)
    if "analysis" in keys:
        del base["time"]
    return "".join((base | keys).values())


def check_scene(block: Block) -> None:
    """Validate a scene or a part of one by making the simulation."""
    import der

    keys = set(TOP_KEY.findall(block.code))
    complete = {"title", "rods"} <= keys
    if block.saved_as:
        if not complete:
            raise Failure("a scene that is saved must be complete")
        Path(block.saved_as).write_text(block.code, encoding="utf-8")
    for text in [block.code] if complete else variants(block.code):
        der.Simulation(der.Scenario.parse(text, str(block)))


def run_page(page: Path) -> bool:
    """Run the blocks of a page in the present folder; tell what failed."""
    names: dict[str, Any] = {"__name__": "__main__"}
    fine = True
    for block in blocks(page):
        if block.left_out:
            print(f"{block}: left out: {block.left_out}", flush=True)
            continue
        start = time.perf_counter()
        try:
            if block.language == "sh":
                run_shell(block)
            elif block.language == "python":
                run_python(block, names)
            else:
                check_scene(block)
        except Exception as error:
            fine = False
            what = str(error) if isinstance(error, Failure) else traceback.format_exc()
            print(f"{block}: FAILED\n{block.code}\n{what}", flush=True)
        else:
            print(f"{block}: ok ({time.perf_counter() - start:.1f} s)", flush=True)
    return fine


def prepare(folder: Path) -> None:
    """Make a folder look like the checkout to commands, which write nothing into the checkout."""
    for name in LINKED:
        (folder / name).symlink_to(ROOT / name)
    (folder / ".venv").symlink_to(sys.prefix)
    scripts = folder / "scripts"
    scripts.mkdir()
    for script in ("run", "test", "reproduce"):
        (scripts / script).write_text(f'#!/bin/sh\nexec "{ROOT}/scripts/{script}" "$@"\n')
        (scripts / script).chmod(0o755)


def failure(page: Path) -> str:
    """Run a page in a process and a folder of its own; return its output if a block fails."""
    programs = Path(sys.executable).parent
    environment = os.environ | {
        "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}",
        "MPLBACKEND": "Agg",
    }
    with tempfile.TemporaryDirectory() as folder:
        prepare(Path(folder))
        try:
            run = subprocess.run(
                [sys.executable, __file__, "--here", str(page)],
                cwd=folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                timeout=TIMEOUT_SECONDS,
                check=False,
                text=True,
            )
        except subprocess.TimeoutExpired as late:
            output = late.stdout or b""
            text = output.decode() if isinstance(output, bytes) else output
            return f"{text}{page}: still running after {TIMEOUT_SECONDS} s\n"
    if run.returncode:
        return run.stdout or f"{page}: exit code {run.returncode}\n"
    print(run.stdout, end="", flush=True)
    return ""


def main(arguments: list[str] | None = None) -> int:
    """Run all blocks of the pages that are named, or of all; return the exit code."""
    parser = argparse.ArgumentParser(description="Run every command and snippet of the pages.")
    parser.add_argument("pages", nargs="*", type=Path, metavar="PAGE", help="default: all pages")
    parser.add_argument("--here", action="store_true", help="in the present folder and process")
    options = parser.parse_args(arguments)
    chosen = [page.resolve() for page in options.pages] or pages()
    if options.here:
        (page,) = chosen
        return 0 if run_page(page) else 1
    if not any(True for page in chosen for _ in blocks(page)):
        print("no block to run: are the pages empty?", file=sys.stderr)
        return 1
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        failures = "".join(pool.map(failure, chosen))
    # Last, where they are seen even if only the end of the output is shown.
    print(failures, end="")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
