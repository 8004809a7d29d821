"""The command der."""

import json
import os
import pkgutil
import re
import signal
import subprocess
import sys
from importlib import import_module

import der
import der.commands
import pytest
from der.cli import main
from matplotlib.image import imread


def command(*arguments, **options):
    line = [sys.executable, "-m", "der", *map(str, arguments)]
    return subprocess.run(line, capture_output=True, text=True, check=False, **options)


@pytest.fixture
def scene(tube, tmp_path):
    path = tmp_path / "tube.yaml"
    path.write_text(der.Scenario.from_dict(tube).to_yaml())
    return path


def test_help_lists_every_command(capsys):
    with pytest.raises(SystemExit) as caught:
        main(["--help"])
    assert caught.value.code == 0
    listed = capsys.readouterr().out
    names = {module.name for module in pkgutil.iter_modules(der.commands.__path__)}
    names = {name for name in names if hasattr(import_module(f"der.commands.{name}"), "execute")}
    assert len(names) >= 10
    assert {line.split()[0] for line in listed.splitlines() if line.startswith("    ")} >= names


def test_without_a_command_it_prints_the_help(capsys):
    assert main([]) == 0
    assert capsys.readouterr().out.startswith("usage: der")


@pytest.mark.parametrize("arguments", [["view"], ["animate"], ["plot", "--what", "shapes"]])
def test_a_sweep_is_told_from_a_run(tube, tmp_path, capsys, arguments):
    der.sweep(tube, {"rods.beam.nodes": [5, 6]}, out=tmp_path / "sweep", frames=True)
    assert main([arguments[0], str(tmp_path / "sweep"), *arguments[1:]]) == 1
    error = capsys.readouterr().err
    assert "a sweep" in error
    if arguments[0] != "plot":
        assert f"`der plot {tmp_path / 'sweep'}` draws it" in error
        kept = tmp_path / "sweep" / "runs"
        assert error.endswith(f"its members are runs, in {kept}\n")
        assert der.open_run(kept / "0000" / "0000001").positions.shape[1] == 6


def test_version(capsys):
    with pytest.raises(SystemExit) as caught:
        main(["--version"])
    assert caught.value.code == 0
    assert capsys.readouterr().out == f"der {der.__version__}\n"


def test_run_is_the_program(scene, tmp_path):
    done = command(
        "run", "--quiet", scene, "--out", tmp_path / "run", "--set", "rods.beam.nodes=11"
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    result = der.open_run(tmp_path / "run")
    assert result.status == "completed"
    assert result.positions.shape[1] == 11
    told = command("run", "--help").stdout
    assert "Usage: der run [OPTIONS]" in told
    assert "  der run configs/cantilever.yaml --check\n" in told
    assert "der_run" not in told
    assert command("run", "--version").stdout == f"der run {der.__version__}\n"
    assert command("run", "no_such.yaml").returncode == 4


def test_examples_are_listed_and_run_by_name(tmp_path, capsys):
    assert main(["examples"]) == 0
    listed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in listed] == [f"example:{name}" for name in der.examples()]
    assert "A soft finger closes and opens" in "".join(listed)
    done = command("run", "--quiet", "example:cantilever", "--out", tmp_path / "run")
    assert (done.returncode, done.stderr) == (0, "")
    assert der.open_run(tmp_path / "run").scenario.title == der.examples()["cantilever"]
    assert main(["check", "example:cantilever"]) == 0
    assert main(["check", "example:cantiliver"]) == 1
    assert "error: there is no example 'cantiliver'; there are " in capsys.readouterr().err


def test_run_with_no_program_to_be_found(monkeypatch, capsys):
    monkeypatch.setattr("sysconfig.get_path", lambda _: "/nowhere")
    monkeypatch.setattr("shutil.which", lambda _: None)
    assert main(["run", "scene.yaml"]) == 1
    assert "der_run" in capsys.readouterr().err


def test_check_valid(scene, capsys):
    assert main(["check", str(scene), str(scene)]) == 0
    captured = capsys.readouterr()
    assert captured.out == f"{scene}: valid (Tube on two supports)\n" * 2
    assert captured.err == ""


def test_check_invalid_goes_on_with_the_other_files(scene, tmp_path, capsys):
    bad = tmp_path / "bad.yaml"
    bad.write_text(scene.read_text().replace("title:", "titel:").replace("nodes: 21", "nodes: x"))
    assert main(["check", str(bad), str(scene)]) == 1
    captured = capsys.readouterr()
    lines = captured.err.splitlines()
    assert lines[0].startswith(f"{bad}:1:1: titel")
    assert len(lines) == 2
    assert "valid" in captured.out


def test_schema(capsys):
    assert main(["schema"]) == 0
    schema = json.loads(capsys.readouterr().out)
    assert "rods" in schema["properties"]
    assert main(["schema", "--markdown"]) == 0
    assert "youngs_modulus" in capsys.readouterr().out


def test_steppers_lists_every_integrator(capsys):
    assert main(["steppers"]) == 0
    header, *rows = capsys.readouterr().out.splitlines()
    assert re.split(r"  +", header) == [
        "name",
        "order",
        "kind",
        "stable",
        "keeps angular momentum",
        "damping",
    ]
    keeps = [row[header.index("keeps") :].split()[0] for row in rows]
    assert keeps == ["yes" if info.keeps_angular_momentum else "no" for info in der.steppers()]
    assert [row.split()[:2] for row in rows] == [
        [info.name, str(info.order)] for info in der.steppers()
    ]
    assert ["verlet", "2", "explicit"] in [row.split()[:3] for row in rows]


def test_plot_writes_a_picture(tube, tmp_path, capsys):
    der.run(tube, out=tmp_path / "run")
    assert main(["plot", str(tmp_path / "run")]) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'run' / 'plot.png'}\n"
    picture = imread(tmp_path / "run" / "plot.png")
    assert picture.shape[1] > 600
    assert len({tuple(pixel) for pixel in picture.reshape(-1, 4)}) > 50

    out = tmp_path / "shapes.svg"
    options = ["--what", "shapes", "--times", "0", "0.5", "--out", str(out)]
    assert main(["plot", str(tmp_path / "run"), *options]) == 0
    assert "<svg" in out.read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["plot", "no_such_run"], "no_such_run"),
        (["plot", "RUN", "--probes", "speed"], "speed"),
        (["plot", "RUN", "--out", "a.jpg"], "a.jpg: a picture ends with .png, .svg or .pdf"),
        (["plot", "RUN", "--out", "a"], "cannot write a:"),
    ],
)
def test_errors_are_one_line_on_stderr(tube, tmp_path, capsys, arguments, words):
    der.run(tube, out=tmp_path / "run")
    arguments = [str(tmp_path / "run") if word == "RUN" else word for word in arguments]
    assert main(arguments) == 1
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert words in error
    assert error.count("\n") == 1


def without_reader(*arguments):
    """Run the command as `der ... | true` does; return exit code and stderr."""
    reading, writing = os.pipe()
    os.close(reading)
    line = [sys.executable, "-m", "der", *arguments]
    done = subprocess.run(line, stdout=writing, stderr=subprocess.PIPE, check=False)
    os.close(writing)
    return done.returncode, done.stderr


@pytest.mark.parametrize("name", ["steppers", "schema"])
def test_a_reader_that_leaves_is_no_error(name):
    assert without_reader(name) == (141, b"")


def test_a_reader_that_leaves_the_help_is_no_error():
    code, error = without_reader("--help")
    assert code in (0, 141)  # argparse hides some errors of its own output
    assert error == b""


def test_run_is_ended_by_sigpipe_as_the_program():
    assert without_reader("run", "--help") == (-signal.SIGPIPE, b"")


def test_no_stdout_is_no_error():
    line = f"{sys.executable} -m der steppers >&-"
    done = subprocess.run(line, shell=True, stderr=subprocess.PIPE, check=False)
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.parametrize("verb", ["plot", "animate", "view"])
def test_a_scene_is_no_run(verb, scene, capsys):
    for name in (str(scene), "example:finger"):
        assert main([verb, name]) == 1
        assert f"is a scene, and no folder of a run: `der run {name}`" in capsys.readouterr().err


def test_study_of_an_example(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["study", "example:cantilever", "--nodes", "11", "21"]) == 0
    assert capsys.readouterr().out.endswith("cantilever_study/study.png\n")
    assert [path.name for path in tmp_path.iterdir()] == ["cantilever_study"]


def test_matplotlib_is_loaded_only_to_draw():
    script = (
        "import sys, der, der.cli\n"
        "der.cli.main(['schema'])\n"
        "sys.exit('matplotlib' in sys.modules or 'h5py' in sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=False)
    assert done.returncode == 0
