"""The codes that are compared, and which of them are installed."""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
from dataclasses import dataclass
from typing import Protocol, cast

from swing.problem import Config, Path2D


class Adapter(Protocol):
    """Interface of a module ``code_*.py``; ``limit`` only if a code solves another continuum."""

    def run(self, config: Config) -> tuple[float, Path2D]:
        """Run one configuration; return CPU seconds of the time loop and the path of the tip."""

    def grid(self, quick: bool) -> list[Config]:
        """Return the configurations that are tried."""


@dataclass(frozen=True)
class Code:
    """A code that can run the swing."""

    key: str  # on the command line
    title: str
    package: str  # imported; found on PyPI as `distribution`
    distribution: str
    module: str  # its adapter

    def is_installed(self) -> bool:
        """Tell whether its package can be imported."""
        return importlib.util.find_spec(self.package) is not None

    def version(self) -> str:
        """Return the version of what is imported."""
        try:
            return importlib.metadata.version(self.distribution)
        except importlib.metadata.PackageNotFoundError:  # not from a package: a build tree
            return str(getattr(importlib.import_module(self.package), "__version__", "unknown"))

    def adapter(self) -> Adapter:
        """Import its adapter, and with it the code itself."""
        return cast(Adapter, importlib.import_module(self.module))

    def limit(self, quick: bool) -> Path2D | None:
        """Return what the code converges to, where that is not the reference."""
        limit = getattr(self.adapter(), "limit", None)
        return None if limit is None else cast(Path2D, limit(quick))


#: The first is the one that the others are compared with.
CODES = (
    Code("der", "der", "der", "der", "swing.code_der"),
    Code("exudyn", "Exudyn", "exudyn", "exudyn", "swing.code_exudyn"),
    Code("mujoco", "MuJoCo", "mujoco", "mujoco", "swing.code_mujoco"),
    Code("pyelastica", "PyElastica", "elastica", "pyelastica", "swing.code_pyelastica"),
)


def missing_text(code: Code) -> str:
    """Say that a code is left out, and how to get it."""
    return f"{code.title}: not installed: pip install der[peers]"
