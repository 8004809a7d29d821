"""The type stubs of der._core say what the module has.

stubtest of mypy compares the names; the signatures, which it cannot see in a compiled module, are
compared here with those that pybind11 writes into the docstrings.
"""

import ast
import importlib.util
import inspect
import re
import subprocess
import sys
from importlib import resources

import pytest
from der import _core

STUB = ast.parse(resources.files("der").joinpath("_core.pyi").read_text())

#: Arrays to write into, whose setters only say so.
WRITABLE = {"positions", "velocities", "theta", "spin", "extra_force"}


def stub_functions():
    """Yield (qualified name, definition) of every function and method of the stub."""
    for item in STUB.body:
        if isinstance(item, ast.FunctionDef):
            yield item.name, item
        if isinstance(item, ast.ClassDef):
            for member in item.body:
                if isinstance(member, ast.FunctionDef):
                    yield f"{item.name}.{member.name}", member


def look_up(qualified):
    found = _core
    for name in qualified.split("."):
        found = (
            inspect.getattr_static(found, name) if inspect.isclass(found) else getattr(found, name)
        )
    return found.__func__ if isinstance(found, staticmethod) else found


def is_property(definition):
    return any(isinstance(d, ast.Name) and d.id == "property" for d in definition.decorator_list)


def stub_signature(definition):
    """Parameters as (kind, name, whether it has a default), without self."""
    arguments = definition.args
    positional = [("/", a.arg) for a in arguments.posonlyargs]
    positional += [("", a.arg) for a in arguments.args]
    defaults = [False] * (len(positional) - len(arguments.defaults))
    defaults += [True] * len(arguments.defaults)
    listed = [(*p, d) for p, d in zip(positional, defaults, strict=True) if p[1] != "self"]
    listed += [
        ("*", a.arg, default is not None)
        for a, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
    ]
    if arguments.kwarg:
        listed.append(("**", arguments.kwarg.arg, False))
    return listed


def docstring_signature(function, *, takes_keywords):
    """The same, read off the first line of a docstring of pybind11."""
    line = function.__doc__.splitlines()[0]
    inside = re.fullmatch(r"\w+\((.*)\) -> .*", line).group(1)
    listed, kind = [], ""
    for part in reversed(split_arguments(inside)):
        name = part.split(":")[0].split("=")[0].strip()
        if name == "/":
            kind = "/"
        elif name == "**kwargs" and not takes_keywords:
            pass  # taken for the sake of a message that says what to write
        elif name in ("*", "*args"):  # the latter are taken for the same reason
            listed = [("*" if kind == "" else kind, *after) for kind, *after in listed]
        elif name.startswith("**"):
            # pybind11 calls them kwargs, the stub by what they are.
            listed.insert(0, ("**", "overrides", False))
        elif name not in ("self", "arg0"):
            listed.insert(0, (kind, name, "=" in part.split(":", 1)[-1]))
    return listed


def split_arguments(text):
    parts, depth = [""], 0
    for character in text:
        depth += {"[": 1, "(": 1, "]": -1, ")": -1}.get(character, 0)
        if character == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    return [part.strip() for part in parts if part.strip()]


@pytest.mark.parametrize(("name", "definition"), list(stub_functions()))
def test_signatures(name, definition):
    found = look_up(name)
    if inspect.isfunction(found):
        return  # written in Python: test_names compares its signature
    if is_property(definition):
        assert isinstance(found, property)
        assert found.fset is None or definition.name in WRITABLE
    else:
        takes_keywords = definition.args.kwarg is not None
        said = docstring_signature(found, takes_keywords=takes_keywords)
        assert said == stub_signature(definition)


def documented():
    for name, definition in stub_functions():
        if definition.name != "__init__":
            yield name
    yield from (item.name for item in STUB.body if isinstance(item, ast.ClassDef))


@pytest.mark.parametrize("name", list(documented()))
def test_everything_has_a_docstring(name):
    lines = [line for line in look_up(name).__doc__.splitlines() if line.strip()]
    text = [line for line in lines if not re.match(r"\w+\(.*\) -> ", line)]
    assert text[0].strip().endswith((".", ":")) or len(text) > 1


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")
def test_names(tmp_path):
    # The metaclass of pybind11, pickling, and constructors that only raise are not promised.
    (tmp_path / "allowed").write_text(
        "der\\._core\\.[A-Z]\\w+\n"
        "der\\._core\\.\\w+\\.__(init|new|getstate|setstate|reduce_ex|repr)__\n"
    )
    line = [sys.executable, "-m", "mypy.stubtest", "der._core", "--ignore-missing-stub"]
    line += ["--allowlist", str(tmp_path / "allowed"), "--ignore-unused-allowlist"]
    done = subprocess.run(line, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_nothing_is_missing_in_the_stub():
    stubbed = {item.name: item for item in STUB.body if hasattr(item, "name")}
    for name, value in vars(_core).items():
        if name.startswith("_"):
            continue
        assert name in stubbed
        if inspect.isclass(value):
            members = {member.name for member in stubbed[name].body if hasattr(member, "name")}
            missing = {m for m in vars(value) if not m.startswith("_")} - members
            assert not missing, f"{name}: {missing}"
