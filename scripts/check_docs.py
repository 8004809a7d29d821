"""Run the commands and the Python code of Markdown pages, so that they cannot rot.

Usage: ``python scripts/check_readme.py [PAGE...]`` (default: the README). Every fenced block marked
``sh`` or ``python`` is run from the root of the checkout with the environment's programs first on
the PATH. A block with ``<!-- no-test -->`` on the line above it is left out.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TIMEOUT_SECONDS = 600
NO_TEST = "<!-- no-test -->"
INTERPRETERS = {
    "sh": ["bash", "-eu", "-o", "pipefail", "-c"],
    "python": [sys.executable, "-c"],
}
FENCE = re.compile(
    r"^```(?P<language>\w+)[^\n]*\n(?P<code>.*?)^```\s*$", flags=re.MULTILINE | re.DOTALL
)


@dataclass(frozen=True)
class Block:
    """A fenced block of a page: its place (1-based line), language and code."""

    page: Path
    line: int
    language: str
    code: str


def blocks(page: Path) -> list[Block]:
    """Return the blocks of a page that are to be run, in order."""
    text = page.read_text(encoding="utf-8")
    found = []
    for match in FENCE.finditer(text):
        before = text[: match.start()].rstrip()
        if match["language"] in INTERPRETERS and not before.endswith(NO_TEST):
            line = text.count("\n", 0, match.start()) + 1
            found.append(Block(page, line, match["language"], match["code"]))
    return found


def passes(block: Block) -> bool:
    """Run a block; print its code and output if it fails."""
    programs = Path(sys.executable).parent
    environment = os.environ | {
        "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}",
        "MPLBACKEND": "Agg",
    }
    try:
        run = subprocess.run(
            [*INTERPRETERS[block.language], block.code],
            cwd=ROOT,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=TIMEOUT_SECONDS,
            check=False,
            text=True,
        )
        problem = f"exit code {run.returncode}" if run.returncode else ""
        output = run.stdout
    except subprocess.TimeoutExpired:
        problem, output = f"still running after {TIMEOUT_SECONDS} s", ""
    print(f"{block.page.name}:{block.line}: {block.language}: {problem or 'ok'}", flush=True)
    if problem:
        print(f"{block.code}\n{output}")
    return not problem


def main(pages: list[str]) -> int:
    """Run all blocks of the given pages; return the exit code."""
    to_run = [block for page in pages or [str(ROOT / "README.md")] for block in blocks(Path(page))]
    if not to_run:
        print("no block to run: is the page empty?", file=sys.stderr)
        return 1
    failures = [block for block in to_run if not passes(block)]
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
