"""The codes that are compared, and which of them are installed."""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
from dataclasses import dataclass
from typing import Protocol, cast

from comparison.scene import Config, Path


class Adapter(Protocol):
    """Interface of a module ``code_*.py``; ``limit`` only if a code solves another continuum."""

    def run(self, config: Config) -> tuple[float, Path]:
        """Run one configuration; return CPU seconds of the time loop and the path of the tip."""

    def grid(self, quick: bool) -> list[Config]:
        """Return the configurations that are tried."""


@dataclass(frozen=True)
class Code:
    """A code that can run a scene."""

    key: str  # on the command line, and in the name of its adapters
    title: str
    package: str  # imported; found on PyPI as `distribution`
    distribution: str

    def is_installed(self) -> bool:
        """Tell whether its package can be imported."""
        return importlib.util.find_spec(self.package) is not None

    def version(self) -> str:
        """Return the version of what is imported."""
        try:
            return importlib.metadata.version(self.distribution)
        except importlib.metadata.PackageNotFoundError:  # not from a package: a build tree
            return str(getattr(importlib.import_module(self.package), "__version__", "unknown"))

    def adapter(self, scene: str) -> Adapter:
        """Import its adapter to a scene, and with it the code itself."""
        return cast(Adapter, importlib.import_module(f"comparison.{scene}.code_{self.key}"))

    def limit(self, scene: str, quick: bool) -> Path | None:
        """Return what the code converges to in a scene, where that is not the reference."""
        limit = getattr(self.adapter(scene), "limit", None)
        return None if limit is None else cast(Path, limit(quick))


DER = Code("der", "der", "der", "der")
EXUDYN = Code("exudyn", "Exudyn", "exudyn", "exudyn")
MUJOCO = Code("mujoco", "MuJoCo", "mujoco", "mujoco")
PYELASTICA = Code("pyelastica", "PyElastica", "elastica", "pyelastica")
DISMECH = Code("dismech", "DiSMech-Newton", "dismech_newton", "dismech-newton")

#: The first is the one that the others are compared with.
CODES = (DER, EXUDYN, MUJOCO, PYELASTICA, DISMECH)


def missing_text(code: Code) -> str:
    """Say that a code is left out, and how to get it."""
    return f"{code.title}: not installed: pip install der[peers]"
