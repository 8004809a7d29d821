"""List the time integrators: order, stability, damping and what each keeps.

In space, where sections twist, sdirk4 and sdirk5 have order 2, with much smaller errors than the
others; the angular momentum is kept to the order of the method.
"""

from __future__ import annotations

import argparse

from der import steppers
from der.tables import text_table


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add no arguments: the list is always whole."""


def execute(arguments: argparse.Namespace) -> int:
    """Print one line for each stepper, in aligned columns."""
    rows = [("name", "order", "kind", "stable", "keeps angular momentum", "damping")]
    for info in steppers():
        kind = "implicit" if info.implicit else "explicit"
        keeps = "yes" if info.keeps_angular_momentum else "no"
        rows.append((info.name, str(info.order), kind, info.stability, keeps, info.damping))
    print("\n".join(text_table(rows)))
    return 0
