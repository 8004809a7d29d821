"""For the site: docstrings of the compiled module, which its type stubs do not repeat."""

from __future__ import annotations

from typing import Any

import griffe
from der import _core


class CompiledDocstrings(griffe.Extension):
    """Give every object of der._core the docstring that it has in the interpreter."""

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:
        """Walk the stubs, once a package is loaded."""
        if pkg.name == "der":
            _describe(pkg.members["_core"], _core)


def _describe(stub: Any, found: Any) -> None:
    for name, member in stub.members.items():
        real = getattr(found, name, None)
        if member.is_alias or real is None:
            continue
        text = getattr(real, "__doc__", None) or ""
        if text and (member.is_class or member.is_function or member.is_attribute):
            member.docstring = griffe.Docstring(text.strip(), parent=member, parser="numpy")
        if member.is_class:
            _describe(member, real)
