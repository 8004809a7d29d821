"""The type stubs of der._core say what the module has.

stubtest of mypy compares the names; the signatures that `inspect` tells are compared here, too,
and every public thing has one.
"""

import ast
import importlib.util
import inspect
import pydoc
import subprocess
import sys
from importlib import resources

import der
import pytest
from der import _core

STUB = ast.parse(resources.files("der").joinpath("_core.pyi").read_text())

#: Arrays to write into, whose setters only say so.
WRITABLE = {"positions", "velocities", "theta", "spin", "extra_force"}


KINDS = {
    inspect.Parameter.POSITIONAL_ONLY: "/",
    inspect.Parameter.POSITIONAL_OR_KEYWORD: "",
    inspect.Parameter.VAR_POSITIONAL: "*args",
    inspect.Parameter.KEYWORD_ONLY: "*",
    inspect.Parameter.VAR_KEYWORD: "**",
}


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


def compiled_signature(function, *, takes_keywords):
    """The same, of a function of the module."""
    listed = []
    for parameter in list(inspect.signature(function).parameters.values()):
        kind = KINDS[parameter.kind]
        if kind == "*args" or (kind == "**" and not takes_keywords):
            continue  # taken for the sake of a message that says what to write
        if parameter.name != "self":
            # pybind11 calls them kwargs, the stub by what they are.
            name = "overrides" if kind == "**" else parameter.name
            listed.append((kind, name, parameter.default is not parameter.empty))
    return listed


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
        said = compiled_signature(found, takes_keywords=takes_keywords)
        assert said == stub_signature(definition)


def documented():
    for name, definition in stub_functions():
        if definition.name != "__init__":
            yield name
    yield from (item.name for item in STUB.body if isinstance(item, ast.ClassDef))


@pytest.mark.parametrize("name", list(documented()))
def test_everything_has_a_docstring(name):
    lines = [line for line in look_up(name).__doc__.splitlines() if line.strip()]
    assert lines[0].strip().endswith((".", ":")) or len(lines) > 1


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")
def test_names(tmp_path):
    # The metaclass of pybind11, pickling, and constructors that only raise are not promised.
    (tmp_path / "allowed").write_text(
        "der\\._core\\.[A-Z]\\w+\n"
        "der\\._core\\.Simulation\\.prescribe\n"  # takes more for the sake of its message
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


def public_functions():
    """Yield what can be called of the package: functions, classes and their methods."""
    for name in der.__all__:
        value = getattr(der, name)
        if not callable(value):
            continue
        if not inspect.isclass(value):
            yield name, value
            continue
        # Warnings are Python's own; a class of the engine without a constructor is only returned.
        returned = value.__module__ == "der._core" and (
            type(vars(value)["__init__"]).__name__ == "wrapper_descriptor"
        )
        if not issubclass(value, Warning) and not returned:
            yield name, value
        for method in vars(value):
            if not method.startswith("_") and callable(getattr(value, method)):
                yield f"{name}.{method}", getattr(value, method)


@pytest.mark.parametrize(("name", "function"), list(public_functions()))
def test_everything_public_has_a_signature_and_a_docstring(name, function):
    signature = inspect.signature(function)
    assert "kwargs" not in str(signature) or name in ("Simulation.prescribe", "Scenario.parse")
    assert inspect.getdoc(function)


def test_help_shows_a_signature():
    assert "step(self, n=1)" in pydoc.plain(pydoc.render_doc(der.Simulation.step))
    assert str(inspect.signature(der.Simulation.record)).startswith(
        "(self, callback=None, until=inf"
    )
