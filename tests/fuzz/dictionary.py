"""Words of the scene reader for libFuzzer: those of `der schema`, and the signs of YAML."""

from __future__ import annotations

import json
from typing import Any

import der

_YAML = [
    ": ",
    "- ",
    "\\x0A  ",
    "[",
    "]",
    "{",
    "}",
    ", ",
    "&a ",
    "*a",
    "|\\x0A",
    ">\\x0A",
    '\\"',
    "'",
    "# ",
    "---\\x0A",
    "!!",
    "<<",
]
_NUMBERS = [
    "0",
    "1",
    "-1",
    "1e-9",
    "1e9",
    "1e308",
    "1e-308",
    ".inf",
    ".nan",
    "2147483648",
    "9223372036854775808",
]
_OWN = ["#set ", "=", "start", "end", "middle", "all", "true", "false", "null"]


def _words(schema: Any) -> set[str]:
    """Names of properties and values of enumerations anywhere in a JSON schema."""
    if isinstance(schema, list):
        return set().union(*map(_words, schema)) if schema else set()
    if not isinstance(schema, dict):
        return set()
    properties = schema.get("properties", {})
    named = set(properties) if isinstance(properties, dict) else set()
    values = [*schema.get("enum", []), schema.get("const")]
    named |= {value for value in values if isinstance(value, str)}
    return named.union(*map(_words, schema.values())) if schema else named


def dictionary() -> str:
    """A dictionary file of libFuzzer, a quoted word a line."""
    words = sorted(_words(json.loads(der.json_schema())))
    keys = [f"{word}: " for word in words]
    return "".join(f'"{word}"\n' for word in [*words, *keys, *_YAML, *_NUMBERS, *_OWN])


if __name__ == "__main__":
    print(dictionary(), end="")
