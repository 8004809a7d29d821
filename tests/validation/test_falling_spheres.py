"""Problems 1 and 2 of the report: spheres on a rod that sinks through a viscous fluid.

References: `references/falling_spheres.py`, an implicit Runge-Kutta solution (SciPy's Radau)
of the same equations of motion with forces derived apart from der's, and the exact balance of
weight and drag.
"""

import der
import numpy as np
import pytest


def richardson(coarse, fine, order):
    """Limit of a sequence of the given order, from steps h and h/2."""
    return fine + (fine - coarse) / (2**order - 1)


def test_three_nodes_as_the_report_runs_it(scene):
    """dt = 1e-2 s, backward Euler: the report's numbers, to the digits that it prints."""
    probes = der.run(scene("falling_beam_3")).summary["probes"]
    assert probes["v_mid"]["final"] == pytest.approx(-0.0059661, abs=5e-8)
    assert probes["y_mid"]["final"] == pytest.approx(-0.066153, abs=5e-7)


@pytest.mark.parametrize("time", [0.01, 0.1, 1.0, 10.0])
def test_three_nodes_time_converged(scene, reference, time):
    """TR-BDF2 with Richardson extrapolation from two steps against the ODE solution."""
    results = [
        der.run(
            scene("falling_beam_3").with_(
                **{
                    "time.duration": time,
                    "time.step": time / steps,
                    "time.integrator": "tr_bdf2",
                    "output.every": time / steps,
                }
            )
        )
        for steps in (2000, 4000)
    ]
    name = f"t{time:g}"
    for probe, quantity in (("y_mid", "y_mid"), ("v_mid", "vy_mid")):
        coarse, fine = (result.probes[probe][-1] for result in results)
        exact = reference("falling_spheres", f"n3.buoyant.tangent.{quantity}.{name}")
        assert richardson(coarse, fine, 2) == pytest.approx(exact, rel=2e-7)


def test_backward_euler_converges_to_the_ode_at_first_order(scene, reference, fitted_order):
    exact = reference("falling_spheres", "n3.buoyant.tangent.y_mid.t1")
    steps = np.array([0.02, 0.01, 0.005])
    errors = [
        der.run(
            scene("falling_beam_3").with_(
                **{"time.duration": 1.0, "time.step": step, "output.every": step}
            )
        ).probes["y_mid"][-1]
        - exact
        for step in steps
    ]
    assert fitted_order(steps, errors) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("density", [0, 1000])
@pytest.mark.parametrize("nodes", [3, 5, 21, 51])
def test_terminal_velocity_balances_weight_and_drag(scene, reference, nodes, density):
    """To 1e-8; the shape relaxes slowly, hence a long run at large steps."""
    falling = scene(f"falling_beam_{nodes}").with_(
        **{
            "loads.1.fluid.density": density,
            "time.duration": 1000.0,
            "time.step": 5.0,
            "output.every": 5.0,
            "solver.step_tolerance": 1e-11,
        }
    )
    kind = "buoyant" if density else "dry"
    exact = reference("falling_spheres", f"terminal.n{nodes}.{kind}")
    assert der.run(falling).probes["v_mid"][-1] == pytest.approx(exact, rel=1e-8)


@pytest.mark.parametrize("step", [1e-2, 1e-1, 1.0, 10.0])
def test_velocity_after_50_s_hardly_depends_on_the_step(scene, step):
    """The report's 0.0068 m/s at 21 nodes, which is the value without buoyancy."""
    falling = scene("falling_beam_21").with_(**{"time.step": step, "output.every": max(step, 0.1)})
    assert der.run(falling).probes["v_mid"][-1] == pytest.approx(-0.0068, abs=5e-5)


def test_equal_spheres_do_not_turn(scene):
    """A symmetric, equally loaded rod falls straight: rounding of positions over the edge length
    is 1e-16 * 0.1 / 0.05, and grows by at most the number of steps."""
    result = der.run(scene("falling_beam_3_equal"))
    assert np.abs(result.probes["angle"]).max() < 1e-12


def test_explicit_small_step_agrees_with_implicit(scene):
    """1e-5 s explicit against 1e-2 s implicit: the latter's first-order error is 7e-7 m."""
    explicit = der.run(scene("falling_beam_3_explicit"))
    implicit = der.run(scene("falling_beam_3"))
    for probe, tolerance in (("y_mid", 2e-6), ("v_mid", 1e-6), ("angle", 1e-3)):
        assert explicit.probes[probe][-1] == pytest.approx(
            implicit.probes[probe][-1], abs=tolerance
        )


def test_explicit_large_step_is_named_diverged(scene):
    """2 m / c of the 5 mm spheres is 7.8e-5 s: 2 * 3.665e-3 kg / 94.25 N s/m."""
    with pytest.raises(der.DivergedError, match="drag") as caught:
        der.run(scene("falling_beam_3_explicit_unstable"))
    assert "7.5" in str(caught.value)  # drag and stretching together: 7.57e-5 s
