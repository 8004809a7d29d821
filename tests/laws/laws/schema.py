"""The leaves of a scene and their units, read off the JSON schema that the reader itself makes."""

from __future__ import annotations

import functools
import json
import re
from collections.abc import Callable, Iterator
from typing import Any

from der import _core

Scene = dict[str, Any]
Schema = dict[str, Any]
#: What becomes of a number or of a list of numbers: key path, value, unit. `ITEM` stands in the
#: path for each list that is gone into.
Change = Callable[[tuple[str, ...], Any, str], Any]

_UNIT = re.compile(r"\[([^\[\]]*)\](?: Default: [^\[\]]*)?$")
ITEM = "[]"
#: Keys of a course over time, under the key that follows it; those that have the unit of that key.
COURSE = {ITEM, "times", "values", "smooth", "sine", "amplitude", "frequency", "phase", "offset"}
_OF_THE_KEY = {"values", "sine", "amplitude", "offset"}


@functools.cache
def schema() -> Schema:
    """The JSON schema of a scene."""
    return json.loads(_core.json_schema())  # type: ignore[no-any-return]


def numbers(value: Any) -> bool:
    """Whether a value is a list of numbers."""
    return isinstance(value, list) and all(
        isinstance(item, int | float) and not isinstance(item, bool) for item in value
    )


def mapped(scene: Scene, change: Change) -> Scene:
    """The scene with its numbers and lists of numbers replaced, each with the unit of its key."""
    return _mapped(scene, schema(), (), "", change)  # type: ignore[no-any-return]


def subject(path: tuple[str, ...]) -> str:
    """The key that a number at a path belongs to, be it constant or an entry of a table."""
    return next(key for key in reversed(path) if key not in COURSE)


def key_paths() -> set[str]:
    """Every key path of the schema, without numbers of items, up to a course over time."""
    return {_short(path) for path in _key_paths(schema(), ())}


def paths_of(scene: Scene) -> set[str]:
    """Every key path of a scene, in the same way and without names of probes."""
    return {_short(path) for path in _paths_of(scene, schema(), ())}


def _short(path: str) -> str:
    return ".".join(key for key in path.split(".") if key not in COURSE)


def vector_keys() -> set[str]:
    """Last keys of all paths that take a vector of two or three components."""
    return {
        subject(tuple(path.split(".")))
        for path in _key_paths(schema(), ())
        if any(_is_vector(form) for form in _forms_at(path))
    }


def _resolved(form: Schema) -> list[Schema]:
    """The alternatives of a schema, references followed."""
    if "$ref" in form:
        return [schema()["$defs"][form["$ref"].rsplit("/", 1)[-1]]]
    if "anyOf" in form:
        return [each for part in form["anyOf"] for each in _resolved(part)]
    return [form]


def _unit(key: str, form: Schema, inherited: str) -> str:
    found = _UNIT.search(form.get("description", ""))
    if key in _OF_THE_KEY:
        return inherited
    return "" if found is None else found[1]


def _properties(value: Scene, form: Schema) -> dict[str, Schema]:
    """The properties of that alternative which has all keys of a mapping."""
    for each in _resolved(form):
        properties = each.get("properties", {})
        if value.keys() <= properties.keys():
            return properties  # type: ignore[no-any-return]
        if "propertyNames" in each:
            return {key: each["additionalProperties"] for key in value}  # noqa: C420
    raise KeyError(f"the schema has no mapping with the keys {sorted(value)}")


def _items(form: Schema) -> Schema:
    """A schema of the items of a list: of every alternative that is one."""
    return {"anyOf": [each["items"] for each in _resolved(form) if each.get("type") == "array"]}


def _mapped(value: Any, form: Schema, path: tuple[str, ...], unit: str, change: Change) -> Any:
    if isinstance(value, dict):
        properties = _properties(value, form)
        return {
            key: _mapped(
                item, properties[key], (*path, key), _unit(key, properties[key], unit), change
            )
            for key, item in value.items()
        }
    if isinstance(value, list) and not numbers(value):
        inner = (*path, ITEM)
        return [_mapped(item, _items(form), inner, unit, change) for item in value]
    if isinstance(value, list) or (isinstance(value, int | float) and not isinstance(value, bool)):
        return change(path, value, unit)
    return value


def _paths_of(value: Any, form: Schema, path: tuple[str, ...]) -> Iterator[str]:
    if isinstance(value, dict):
        properties = _properties(value, form)
        named = any("propertyNames" in each for each in _resolved(form))
        for key, item in value.items():
            inner = path if named else (*path, key)
            if not named:
                yield ".".join(inner)
            yield from _paths_of(item, properties[key], inner)
    elif isinstance(value, list) and not numbers(value):
        for item in value:
            yield from _paths_of(item, _items(form), path)


def _key_paths(form: Schema, path: tuple[str, ...]) -> Iterator[str]:
    for each in _resolved(form):
        if "propertyNames" in each:
            yield from _key_paths(each["additionalProperties"], path)
        for key, inner in each.get("properties", {}).items():
            yield ".".join((*path, key))
            yield from _key_paths(inner, (*path, key))
        if each.get("type") == "array":
            yield from _key_paths(each["items"], path)


def _forms_at(path: str) -> list[Schema]:
    """All schemas of the values at a key path."""
    forms = [schema()]
    for key in path.split("."):
        forms = [
            form["properties"][key]
            for start in forms
            for form in _inner(start)
            if key in form.get("properties", {})
        ]
    return [each for form in forms for each in _inner(form)]


def _inner(form: Schema) -> Iterator[Schema]:
    """A schema, what its lists hold and what its names stand for."""
    for each in _resolved(form):
        yield each
        if each.get("type") == "array":
            yield from _inner(each["items"])
        if "propertyNames" in each:
            yield from _inner(each["additionalProperties"])


def _is_vector(form: Schema) -> bool:
    """Whether it takes lists of two or three numbers."""
    return (
        form.get("type") == "array"
        and form.get("maxItems") == 3
        and "number" in form["items"].get("type", "")
    )
