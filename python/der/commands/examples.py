"""List the scenes that come with the package, with one line each.

Their names stand where a scene file can: `der run example:finger`, `der verify example:finger`.
"""

from __future__ import annotations

import argparse

from der.examples import PREFIX, examples
from der.tables import text_table


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add no arguments: the list is always whole."""


def execute(arguments: argparse.Namespace) -> int:
    """Print name and title of each scene, in aligned columns."""
    rows = [(PREFIX + name, title) for name, title in examples().items()]
    print("\n".join(text_table(rows)))
    return 0
