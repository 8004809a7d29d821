"""Problem 3 of the report: a tube on two supports under a point load, settled.

References: `references/extensible_beam.py`, the geometrically exact extensible rod by shooting,
and Euler-Bernoulli's formula beside it.
"""

import der
import pytest


def settled(scenario):
    """Static equilibrium under the same loads and supports."""
    tree = scenario.to_dict()
    del tree["time"]
    tree["analysis"] = "static"
    tree["output"].pop("every", None)
    return der.run(der.Scenario.from_dict(tree))


@pytest.mark.parametrize(
    ("name", "load"), [("simply_supported", 2000), ("simply_supported_20kN", 20000)]
)
def test_deflection_converges_at_second_order(scene, reference, fitted_order, name, load):
    """The load stands at 0.75 m: in the middle of an edge, a quarter of one away from a node, and
    on a node, and the order shows all the same."""
    nodes = [51, 100, 201, 399]
    sizes = [1.0 / (n - 1) for n in nodes]
    deflections, rollers = [], []
    for n in nodes:
        result = settled(scene(name).with_(**{"rods.beam.nodes": n}))
        deflections.append(-result.probes["deflection"][-1])
        rollers.append(result.probes["roller"][-1] - 1.0)
    exact = reference("extensible_beam", f"tube.{load}.deflection")
    roller = reference("extensible_beam", f"tube.{load}.roller")
    assert fitted_order(sizes, [d - exact for d in deflections]) > 1.9
    assert fitted_order(sizes, [r - roller for r in rollers]) > 1.9
    # Error constant of a second-order method with 50 elements: below 1e-3 of the deflection.
    assert deflections[0] == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("name", ["simply_supported", "simply_supported_20kN"])
def test_the_dynamic_run_settles_to_the_equilibrium(scene, name):
    moving = der.run(scene(name))
    assert moving.status == "completed"
    assert moving.probes["deflection"][-1] == pytest.approx(
        settled(scene(name)).probes["deflection"][-1], rel=1e-8
    )


def test_small_loads_agree_with_euler_bernoulli(scene, reference):
    """At 20 N the slope is 1e-3: linear theory is right to 1e-6, the mesh to 1e-4."""
    light = scene("simply_supported").with_(
        **{"rods.beam.nodes": 201, "loads.0.point_force.force": [0, -20]}
    )
    linear = reference("extensible_beam", "euler_bernoulli.20.deflection")
    assert -settled(light).probes["deflection"][-1] == pytest.approx(linear, rel=1e-4)


def test_euler_bernoulli_is_far_off_at_20_kn(reference):
    exact = reference("extensible_beam", "tube.20000.deflection")
    assert reference("extensible_beam", "euler_bernoulli.20000.deflection") > 1.5 * exact
