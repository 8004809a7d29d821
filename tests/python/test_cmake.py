"""Messages of a build before it compiles anything."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CMAKE = shutil.which("cmake")

pytestmark = pytest.mark.skipif(CMAKE is None, reason="without CMake nothing is built")


def configured(folder, *options, **environment):
    """Return a run of CMake on a project that needs what der needs."""
    (folder / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.22)\n"
        "project(needs LANGUAGES NONE)\n"
        "set(DER_WITH_CHOLMOD OFF)\n"
        f'list(APPEND CMAKE_MODULE_PATH "{ROOT / "cmake"}")\n'
        "include(DerDependencies)\n"
    )
    line = [CMAKE, "-S", folder, "-B", folder / "build", *options]
    return subprocess.run(
        line, check=False, capture_output=True, text=True, env={**os.environ, **environment}
    )


def test_missing_libraries_are_named_at_once_with_what_installs_them(tmp_path):
    hidden = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in ("fmt", "Spectra", "HDF5")]
    done = configured(tmp_path, *hidden)
    assert done.returncode != 0
    lines = [line.strip() for line in done.stderr.splitlines()]
    assert "this is not there: fmt, Spectra, HDF5." in " ".join(lines)
    for line in (
        "apt install libfmt-dev libspectra-dev libhdf5-dev",
        "dnf install fmt-devel spectra-devel hdf5-devel",
        "brew install fmt spectra hdf5",
        "conda install -c conda-forge fmt spectralib hdf5",
    ):
        assert line in lines


def test_a_missing_compiler_is_named_beside_the_libraries(tmp_path):
    done = configured(tmp_path, CXX="no-compiler")
    assert done.returncode != 0
    assert "this is not there: a C++ compiler, Eigen3, fmt," in " ".join(done.stderr.split())
    assert done.stderr.count("CMake Error") == 1
    assert "apt install g++ libeigen3-dev" in done.stderr


def test_nothing_is_said_where_all_libraries_are(tmp_path):
    done = configured(tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


def test_the_citation_and_the_recipe_have_the_version():
    version = (ROOT / "CMakeLists.txt").read_text().split("VERSION ")[2].split()[0]
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text()
    assert f"\n  version: {version}\n" in (ROOT / "conda" / "recipe" / "recipe.yaml").read_text()
