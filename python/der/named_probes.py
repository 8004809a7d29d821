"""Dicts with a value for each probe of a scene, by its name."""

from __future__ import annotations

from typing import Generic, NoReturn, TypeVar

Value = TypeVar("Value")


class NamedProbes(dict[str, Value], Generic[Value]):
    """A dict whose KeyError says which probes the scene has."""

    def __missing__(self, name: object) -> NoReturn:
        """Refuse a name that no probe has."""
        known = ", ".join(repr(known) for known in self) or "none, and takes them in output.probes"
        raise KeyError(f"the scene has no probe {name!r}; it has {known}")
