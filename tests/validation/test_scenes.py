"""Every scene of configs/ runs and ends as its header says."""

from pathlib import Path

import der
import pytest

CONFIGS = sorted((Path(__file__).resolve().parents[2] / "configs").glob("*.yaml"))


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_scene_runs(path):
    fails = "# expect: failure" in path.read_text().splitlines()
    result = der.run(path, check=False)
    assert (result.status not in ("completed", "static_converged")) == fails
