"""Sweeps on a Dask cluster of processes, one of which is killed."""

import gc
import os
import signal
import threading

import der
import numpy as np
import pytest
from der.cli import main
from der.sweeps import sweeper
from der.sweeps.chunk import Chunk
from der.sweeps.executors import connect, place_for
from sweep_scenes import FORCE, STIFFNESS, bits, cantilever, of_each_kind

distributed = pytest.importorskip("distributed")

SCENE = cantilever(nodes=101)
VARY = {
    FORCE: np.linspace(-5.0, 0.0, 300),
    STIFFNESS: [1.0, -1.0],
}


@pytest.fixture(scope="module")
def cluster():
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=True,
        dashboard_address=None,
        silence_logs=50,
    ) as made:
        yield made


@pytest.mark.filterwarnings("ignore::ResourceWarning")
def test_a_killed_worker_loses_no_row(cluster, tmp_path, monkeypatch):
    """The chunks that it had are run again by the others: same rows as with threads."""
    monkeypatch.setattr(sweeper, "_CHUNK_MEMBERS", 20)  # so that some are out at any time
    client = connect(cluster.scheduler_address)
    victims = list(client.run(os.getpid).values())
    killed = threading.Event()

    def kill(share):
        if share > 0.2 and not killed.is_set():
            os.kill(victims[0], signal.SIGKILL)
            killed.set()

    with client:
        with place_for(client, None) as place:
            assert place.at_once() == 4  # two chunks for each worker, however many members
        swept = der.sweep(SCENE, VARY, out=tmp_path / "s", executor=client, progress=kill)
    assert killed.is_set()
    assert bits(swept) == bits(der.sweep(SCENE, VARY))


@pytest.mark.parametrize("kind", of_each_kind())
def test_the_same_bits_in_threads_and_on_a_cluster(cluster, kind):
    scene, vary = of_each_kind()[kind], {STIFFNESS: [*np.linspace(0.2, 2.0, 12), -1.0]}
    with connect(cluster.scheduler_address) as client:
        swept = der.sweep(scene, vary, executor=client)
    assert bits(swept) == bits(der.sweep(scene, vary))


def test_the_scheduler_keeps_no_members(cluster):
    """It is in this process. Its log of messages would grow to gigabytes if they held members."""
    with connect(cluster.scheduler_address) as client:
        der.sweep(SCENE, {FORCE: np.linspace(-5.0, 0.0, 200)}, executor=client)
        gc.collect()
        assert not [each for each in gc.get_objects() if type(each) is Chunk]


@pytest.mark.parametrize("options", [[], ["--frames", "--verify"]], ids=["plain", "all"])
def test_the_command(cluster, options, tmp_path, capsys):
    path, out = tmp_path / "cantilever.yaml", tmp_path / "s"
    path.write_text(der.Scenario.from_dict(cantilever()).to_yaml())
    line = ["sweep", str(path), "--vary", f"{FORCE}=-2:0:12", "--out", str(out), *options]
    before = cluster.scheduler.transition_counter
    assert main([*line, "--dask", cluster.scheduler_address]) == 0
    assert cluster.scheduler.transition_counter > before  # the cluster had something to do
    assert "Cantilever: 12 members, none failed" in capsys.readouterr().out
    swept = der.load_sweep(out)
    assert bits(swept) == bits(der.sweep(cantilever(), {FORCE: "-2:0:12"}, verify=bool(options)))
    folders = sorted(out.glob("runs/*/*"))
    assert len(folders) == (12 if options else 0)
    for folder, row in zip(folders, swept.rows, strict=False):
        assert der.open_run(folder).probes["tip_y"].summary["final"] == row["tip_y.final"]


def test_the_file_of_a_scheduler(cluster, tmp_path):
    """Also one that is being written when it is read first."""
    path = tmp_path / "scheduler.json"
    path.write_text('{"type": "Sched')
    written = threading.Timer(
        0.3, path.write_text, [f'{{"address": "{cluster.scheduler_address}"}}']
    )
    written.start()
    with connect(str(path)) as client:
        assert client.status == "running"
    written.join()


def test_nobody_at_the_address():
    import dask

    impatient = dask.config.set({"distributed.comm.timeouts.connect": "0.2s"})
    with impatient, pytest.raises(OSError, match="Timed out"):
        connect("tcp://127.0.0.1:9")


@pytest.mark.parametrize(
    "content",
    [
        b"title: a scene",
        b"{}",
        b'{"type": "Scheduler"}',
        b"[1]",
        b"\xff\x00",
        b"",
        b'{"address": 5}',
    ],
)
def test_files_of_no_scheduler(content, tmp_path, capsys):
    """Dask met them with an AssertionError."""
    path = tmp_path / "scheduler.json"
    path.write_bytes(content)
    line = ["sweep", "scene.yaml", "--vary", "a=1", "--out", str(tmp_path / "s")]
    assert main([*line, "--dask", str(path)]) == 1
    error = capsys.readouterr().err
    assert error.startswith(f"error: '{path}' is no scheduler (")
    assert error.endswith("write tcp://HOST:PORT, or the path of a scheduler file\n")
    with pytest.raises(ValueError, match=r"is no scheduler \(it is a folder\): write tcp"):
        connect(str(tmp_path))


def test_a_closed_client(cluster):
    client = connect(cluster.scheduler_address)
    client.close()
    with pytest.raises(ValueError, match="the Dask client is closed: connect a new one"):
        der.sweep(SCENE, {FORCE: [-1.0]}, executor=client)
