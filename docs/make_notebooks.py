"""Make notebooks of tutorials: their text and their code, cell by cell.

    python docs/make_notebooks.py

A page is the one source: change it, and run this again. `tests/python/test_docs.py` runs the
notebooks and checks that they are those of the pages.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

TUTORIALS = Path(__file__).parent / "tutorials"
#: Pages whose code runs from the top to the end without the rest of a program.
PAGES = ("beam_study", "control")
_CODE = re.compile(r"^```python\n(.*?)^```\n", re.DOTALL | re.MULTILINE)
_MARK = re.compile(r"<!-- (?:no-test|exit-code)[^>]*-->\n")


def notebook(page: str) -> str:
    """Return the notebook of a tutorial as the text of its file."""
    text = _MARK.sub("", (TUTORIALS / f"{page}.md").read_text(encoding="utf-8"))
    parts = _CODE.split(text)  # words and code in turns
    cells = [
        _cell("code" if number % 2 else "markdown", part.strip("\n"), number)
        for number, part in enumerate(parts)
        if part.strip()
    ]
    python = {"display_name": "Python 3", "language": "python", "name": "python3"}
    whole = {
        "cells": cells,
        "metadata": {"kernelspec": python, "language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


def _cell(kind: str, text: str, number: int) -> dict[str, Any]:
    cell: dict[str, Any] = {"cell_type": kind, "id": f"cell-{number}", "metadata": {}}
    if kind == "code":
        cell |= {"execution_count": None, "outputs": []}
    return cell | {"source": text.splitlines(keepends=True)}


def main() -> None:
    """Write all notebooks."""
    for page in PAGES:
        (TUTORIALS / f"{page}.ipynb").write_text(notebook(page), encoding="utf-8")


if __name__ == "__main__":
    main()
