"""The error bars of `der verify`, on every scene of configs/, against much finer runs.

Long scenes are cut to some hundred of their steps, so that this stays quick; with fewer steps the
bars have more to hold, not less.
"""

import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import der
import pytest
from der.accuracy.readings import read_run
from der.accuracy.refinement import with_elements, with_time
from der.accuracy.time_levels import find_stepper, fixed_step, save_every_step

CONFIGS = sorted((Path(__file__).resolve().parents[2] / "configs").glob("*.yaml"))
MOST_STEPS = {"implicit": 200, "explicit": 100_000}
#: So many nodes, and the writhe of a ring at each step, take longer.
FEWER_STEPS = {"helical_buckling": 50, "twisted_ring": 20}


def fails(path):
    return "# expect: failure" in path.read_text(encoding="utf-8").splitlines()


def shortened(path):
    scenario = der.load(path)
    if scenario.is_static:
        return scenario
    base = der.run(scenario)
    implicit = find_stepper(base.summary["integrator"]).implicit
    usual = MOST_STEPS["implicit" if implicit else "explicit"]
    steps = FEWER_STEPS.get(path.stem, usual)
    step = fixed_step(base)
    if scenario.duration <= steps * step:
        return scenario
    return with_time(scenario, duration=steps * step, every=max(1, steps // 100) * step)


def truth(scenario):
    """On 8 times the elements (rods with spheres at every node keep theirs), and in time with 16
    times the steps of another stepper, or 8 times those of an explicit one.

    At order 2 that leaves 1/64 of the scene's error, where a bar has a quarter to spare.
    """
    finer = with_elements(scenario, 8)
    # Rounding errors of so many elements put much tighter tolerances out of reach.
    tight = {"solver.residual_tolerance": 1e-11, "solver.step_tolerance": 1e-11}
    if scenario.is_static:
        try:
            return der.run(finer.with_(**tight))
        except der.NotConvergedError:  # rounding does not allow as much everywhere
            return der.run(finer)
    base = der.run(scenario)
    keys = ("every", "tolerance", "minimum_step", "spectral_radius", "allow_unstable")
    changes = dict.fromkeys(keys)
    if find_stepper(base.summary["integrator"]).implicit:
        changes |= {"integrator": "generalized_alpha", "spectral_radius": 0.5}
        changes["step"] = fixed_step(base) / 16
    else:
        changes["step"] = fixed_step(base) / 8
    return der.run(save_every_step(with_time(finer, **changes), changes["step"]))


def within_bars(path):
    """The scene's dimension; for each value, whether the truth is within its bar."""
    scenario = shortened(path)
    verification = der.verify(scenario)
    exact = read_run(truth(verification.scenario))

    held = {
        (path.stem, value.probe, value.what): abs(value.value - exact[value.label].value)
        <= value.error_bar
        # The turning angle belongs to its mesh, and the truth stands on another one.
        or (value.space is None and len(verification.meshes) > 1)
        for value in verification.values
    }
    return der.Model(scenario).dimension, held


def test_true_errors_lie_within_the_bars():
    scenes = [path for path in CONFIGS if not fails(path)]
    held = {2: {}, 3: {}}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for dimension, part in pool.map(within_bars, scenes):
            held[dimension] |= part
    assert len(held[2]) >= 100
    assert len(held[3]) >= 40
    for values in held.values():
        outside = [name for name, inside in values.items() if not inside]
        assert len(outside) <= 0.05 * len(values), outside


@pytest.mark.parametrize(
    ("name", "probe", "problem", "value", "offset", "sign"),
    [
        ("cantilever", "tip_y", "elastica", "tip_load.1.y", 0.0, -1.0),
        ("cantilever", "tip_x", "elastica", "tip_load.1.x", 0.0, 1.0),
        ("simply_supported", "deflection", "extensible_beam", "tube.2000.deflection", 0.0, -1.0),
        ("simply_supported_20kN", "roller", "extensible_beam", "tube.20000.roller", 1.0, 1.0),
    ],
)
def test_bars_of_equilibria_hold_the_continuum(
    scene, reference, name, probe, problem, value, offset, sign
):
    """And are not wider than three times the true error."""
    static = der.equilibrium(scene(name)).scenario
    if name == "simply_supported_20kN":
        # The load is between nodes on the mesh of the scene, and at a node on the next ones: it is
        # large enough for what that changes to be seen.
        static = static.with_(**{"rods.beam.nodes": 101})
    found = der.verify(static)[probe]
    exact = offset + sign * reference(problem, value)
    error = abs(found.value - exact)
    assert error <= found.error_bar <= 3.0 * error
    assert abs(found.extrapolated - exact) <= 0.1 * error
    assert not found.flagged


def test_bars_of_a_path_hold_the_limit_loads_of_the_continuum(scene, reference):
    """And the loads at its bifurcations; `references/arch.py` follows the continuum."""
    found = der.verify(scene("snap_through_arch"))
    for event, problem in (("fold", "limits"), ("bifurcation", "bifurcations")):
        for number in (1, 2):
            exact = reference("arch", f"arch.rise0.05.{problem}.{number}.load")
            value = found["factor", f"{event} {number}"]
            error = abs(value.value - exact)
            assert error <= value.error_bar <= 3.0 * error
            assert abs(value.extrapolated - exact) <= 0.1 * error
    assert not found.flagged
    assert {value.what.split()[0] for value in found.values} == {"fold", "bifurcation", "end"}


@pytest.mark.parametrize("path", [path for path in CONFIGS if fails(path)], ids=lambda p: p.stem)
def test_scene_that_fails_has_nothing_to_verify(path):
    with pytest.raises(der.DerError, match=r"time\.step"):
        der.verify(path)
