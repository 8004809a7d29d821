"""Sweeps as tables for other programs."""

import csv
import importlib
import os
import sys

import der
import numpy as np
import pytest
from der.cli import main
from sweep_scenes import FORCE, STIFFNESS, cantilever

CANTILEVER = cantilever()


def package_of_tables(name):
    """Import a package of the extra `tables`; without it a test is skipped, but not in CI."""
    required = os.environ.get("DER_REQUIRE_TABLES") == "1"
    return importlib.import_module(name) if required else pytest.importorskip(name)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A sweep with failed members, and values of all kinds."""
    out = tmp_path_factory.mktemp("sweeps") / "s"
    der.sweep(CANTILEVER, {FORCE: [-2, -1.5], STIFFNESS: [1.0, -1.0]}, out=out)
    return out


def test_csv(folder, capsys):
    assert main(["export", str(folder), "--format", "csv"]) == 0
    path = folder / "sweep.csv"
    assert capsys.readouterr().out == f"{path}\n"
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    sweep = der.load_sweep(folder)
    assert len(rows) == 4
    for row, own in zip(rows, sweep.rows, strict=True):
        assert row["status"] == own["status"]
        assert float(row[FORCE]) == own[FORCE]
        value = row["tip_y.final [m]"]
        assert (float(value) if value else None) == own["tip_y.final"]


def test_npz(folder, tmp_path):
    der.load_sweep(folder).export("npz", tmp_path / "table")
    with np.load(tmp_path / "table.npz") as arrays:
        assert arrays[FORCE].tolist() == [-2.0, -2.0, -1.5, -1.5]
        assert np.isnan(arrays["tip_y.final"]).tolist() == [False, True, False, True]
        assert arrays["units/tip_y.final"] == "m"
        assert "Cantilever" in str(arrays["scene"])


def test_numpy(folder):
    sweep = der.load_sweep(folder)
    table = sweep.to_numpy()
    assert table.shape == (4,)
    assert table["member"].dtype == np.int64
    assert table["status"].tolist() == [row["status"] for row in sweep.rows]
    np.testing.assert_array_equal(table["tip_y.final"], sweep["tip_y"])
    with pytest.raises(KeyError, match=r"no column 'tip_z'; it has: member, loads\.0"):
        sweep["tip_z"]


def test_pandas(folder):
    package_of_tables("pandas")
    sweep = der.load_sweep(folder)
    table = sweep.to_pandas()
    assert list(table.columns) == ["tip_y"]
    assert table.index.names == [FORCE, STIFFNESS]
    assert table.index.to_list() == [(-2.0, 1.0), (-2.0, -1.0), (-1.5, 1.0), (-1.5, -1.0)]
    assert table["tip_y"].isna().tolist() == [False, True, False, True]
    assert table.attrs["units"] == {"tip_y": "m"}
    chosen = sweep.to_pandas(["tip_y", "status", "tip_y.max"])
    assert list(chosen.columns) == ["tip_y", "status", "tip_y.max"]
    assert chosen["status"].tolist() == [row["status"] for row in sweep.rows]
    with pytest.raises(KeyError, match="no column 'tip_z'"):
        sweep.to_pandas(["tip_z"])


def test_three_answers_are_three_columns_of_pandas():
    package_of_tables("pandas")
    table = der.sweep("example:cantilever", {"rods.arm.nodes": [5, 7]}).to_pandas()
    assert list(table.columns) == ["tip_x", "tip_y", "root_moment"]
    assert table.index.to_list() == [5, 7]


def test_parquet(folder, tmp_path):
    parquet = package_of_tables("pyarrow.parquet")
    der.load_sweep(folder).export("parquet", tmp_path / "table.parquet")
    table = parquet.read_table(tmp_path / "table.parquet")
    assert table.num_rows == 4
    assert table.schema.field("tip_y.final").metadata == {b"unit": b"m"}
    assert table["tip_y.final"].to_pylist() == der.load_sweep(folder).values["tip_y.final"]


def test_parquet_of_words_beside_numbers(tmp_path):
    parquet = package_of_tables("pyarrow.parquet")
    sweep = der.sweep(cantilever(), {"supports.0.at": ["start", 0]})
    sweep.export("parquet", tmp_path / "table.parquet")
    table = parquet.read_table(tmp_path / "table.parquet")
    assert table["supports.0.at"].to_pylist() == ["start", "0"]


def test_packages_that_are_missing(folder, tmp_path, monkeypatch, capsys):
    for name in ("pandas", "pyarrow", "distributed"):
        monkeypatch.setitem(sys.modules, name, None)
    sweep = der.load_sweep(folder)
    with pytest.raises(ModuleNotFoundError, match="pandas"):
        sweep.to_pandas()
    with pytest.raises(ModuleNotFoundError, match="pyarrow"):
        sweep.export("parquet", tmp_path / "x")
    line = ["sweep", "scene.yaml", "--vary", "a=1", "--out", str(tmp_path / "s")]
    assert main([*line, "--dask", "tcp://127.0.0.1:8786"]) == 1
    needed = "error: Dask needs the package distributed: pip install 'der[dask]'\n"
    assert capsys.readouterr().err == needed
    with pytest.raises(ValueError, match="a sweep is not written as 'vtk'"):
        sweep.export("vtk", tmp_path / "x")
