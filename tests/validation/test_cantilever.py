"""Cantilevers: tip load against the elastica, self weight, roll-up, natural curvature, moments.

References: `references/elastica.py` (elliptic integrals) and `references/extensible_beam.py`.
"""

import der
import numpy as np
import pytest

SIZES = [10, 20, 40, 80]


def tip(scenario):
    return der.run(scenario).positions[-1, -1]


def tip_errors(scenario, exact, sizes=SIZES, **changes):
    """Distance of the tip from `exact` (x, and how far down) for every mesh of `sizes`, in L."""
    errors = []
    for n in sizes:
        x, y = tip(scenario.with_(**{"rods.arm.nodes": n + 1}, **changes))
        errors.append(np.hypot(x - exact[0], -y - abs(exact[1])))
    return errors


def stiffness_and_load(EA, load):
    return {"rods.arm.cross_section.stiffness.EA": EA, "loads.0.point_force.force": [0, -load]}


@pytest.mark.parametrize(("load", "error_at_10"), [(1, 2e-3), (10, 6e-3)])
def test_tip_load_converges_to_the_elastica_at_second_order(
    scene, reference, fitted_order, load, error_at_10
):
    # EA L^2 / EI = 1e8: the stretch of 1e-8 L is far below the finest mesh's error of 2e-5 L.
    exact = [reference("elastica", f"tip_load.{load}.{c}") for c in "xy"]
    errors = tip_errors(scene("cantilever"), exact, **stiffness_and_load(1e8, load))
    assert errors[0] < error_at_10
    assert fitted_order([1 / n for n in SIZES], errors) > 1.9


@pytest.mark.parametrize("load", [1, 10])
def test_tip_load_with_stretch_converges_at_second_order(scene, reference, fitted_order, load):
    name = f"cantilever.slenderness100.load{load}"
    exact = [reference("extensible_beam", f"{name}.{c}") for c in "xy"]
    errors = tip_errors(scene("cantilever"), exact, **stiffness_and_load(1e2, load))
    assert fitted_order([1 / n for n in SIZES], errors) > 1.9


@pytest.mark.parametrize("curvature", ["angle", "tangent"])
def test_both_curvature_measures_converge(scene, reference, fitted_order, curvature):
    exact = [reference("elastica", f"tip_load.2.{c}") for c in "xy"]
    changes = {"rods.arm.curvature": curvature, **stiffness_and_load(1e8, 2)}
    errors = tip_errors(scene("cantilever"), exact, **changes)
    assert fitted_order([1 / n for n in SIZES], errors) > 1.9


@pytest.mark.parametrize(
    ("load", "deflection", "error"),
    [
        ({"point_force": {"rod": "arm", "at": "end", "force": [0, -1e-3]}}, 1e-3 / 3, 1e-6),
        ({"moment": {"rod": "arm", "at": "end", "moment": -1e-3}}, 1e-3 / 2, 1e-6),
        ({"distributed_force": {"rod": "arm", "force": [0, -1e-3]}}, 1e-3 / 8, 1e-3),
    ],
)
def test_small_deflections_have_no_error_of_second_order(scene, load, deflection, error):
    """The linear theory (P L^3/3EI, M L^2/2EI, w L^4/8EI) at 10 elements, where a clamp that starts
    its edge from the node is off by 0.5 (l/L)^2 = 5e-3. End loads are exact but for the load
    squared, 1e-6; a distributed load bends the moment within an edge, of order (l/L)^3."""
    small = scene("cantilever").to_dict()
    small["rods"][0]["cross_section"]["stiffness"]["EA"] = 1e7
    small["loads"] = [load]
    small["solver"] = {"residual_tolerance": 1e-12, "step_tolerance": 1e-12}
    y = tip(der.Scenario.from_dict(small).with_(**{"rods.arm.nodes": 11}))[1]
    assert -y / deflection == pytest.approx(1, abs=error)


@pytest.mark.parametrize("weight", [1, 10, 100])
def test_self_weight_as_a_distributed_force(scene, reference, fitted_order, weight):
    # At weight 100 the rod hangs but for a bend of (EI/w L^3)^(1/3) L = 0.2 L at the clamp, which
    # 10 elements do not resolve.
    sizes = SIZES if weight < 100 else [20, 40, 80, 160]
    exact = [reference("elastica", f"self_weight.{weight}.{c}") for c in "xy"]
    heavy = scene("cantilever").to_dict()
    heavy["rods"][0]["cross_section"]["stiffness"]["EA"] = 1e9
    heavy["loads"] = [{"distributed_force": {"rod": "arm", "force": [0, -weight]}}]
    errors = tip_errors(der.Scenario.from_dict(heavy), exact, sizes)
    assert fitted_order([1 / n for n in sizes], errors) > 1.9


def test_a_force_between_nodes_does_not_jump_to_one(scene, fitted_order):
    """A load at 0.7 L: the tip of the free part beyond it must converge at second order though
    the load's place in its edge changes from mesh to mesh (0.1, 0.2, 0.4, 0.8, ...). The reference
    is a mesh with a node at the load, Richardson-extrapolated."""

    def tip_y(n):
        return tip(
            scene("cantilever").with_(
                **{
                    "rods.arm.nodes": n + 1,
                    "loads.0.point_force.at": 0.7,
                    "loads.0.point_force.force": [0, -4],
                }
            )
        )[1]

    exact = tip_y(400) + (tip_y(400) - tip_y(200)) / 3
    counts = [13, 23, 43, 83]
    errors = [tip_y(n) - exact for n in counts]
    assert fitted_order([1 / n for n in counts], errors) > 1.9


@pytest.mark.parametrize("name", ["roll_up", "natural_curvature"])
def test_the_rod_closes_to_a_circle(scene, fitted_order, name):
    """An end moment of 2 pi EI/L, or a natural curvature of 2 pi/L: the tip comes back to the
    clamp, the diameter is L/pi."""
    sizes = [10, 20, 40, 80]
    gaps = []
    diameters = []
    for n in sizes:
        result = der.run(scene(name).with_(**{"rods.strip.nodes": n + 1}))
        gaps.append(np.linalg.norm(result.positions[-1, -1] - result.positions[-1, 0]))
        diameters.append(result.probes["top"][-1] - 1 / np.pi)
    assert fitted_order([1 / n for n in sizes], gaps) > 2.5
    assert fitted_order([1 / n for n in sizes], diameters) > 2.5
    assert gaps[-1] < 1e-5


def test_natural_curvature_leaves_no_stress(scene):
    result = der.run(scene("natural_curvature"))
    assert result.energies["bend"][-1] + result.energies["stretch"][-1] < 1e-9


def test_a_prescribed_rotation_of_a_clamp_turns_the_free_rod(scene):
    """Slowly turned by 90 degrees without load, the rod follows rigidly."""
    turned = scene("cantilever").to_dict()
    del turned["analysis"]
    turned["loads"] = [{"damping": {"coefficient": 1.0}}]
    turned["supports"][0]["prescribe"] = {"angle": {"times": [0, 5], "values": [0, np.pi / 2]}}
    turned["time"] = {"duration": 40, "step": 0.1, "integrator": "implicit_euler"}
    result = der.run(der.Scenario.from_dict(turned))
    assert result.positions[-1, -1] == pytest.approx([0, 1], abs=1e-6)


def test_bending_moment_at_the_clamp_balances_the_load(scene, fitted_order):
    """The clamp's moment is that of its cell carried on to the wall: of second order."""
    errors = []
    for n in SIZES:
        result = der.run(scene("cantilever").with_(**{"rods.arm.nodes": n + 1}))
        arm = result.positions[-1, -1, 0]
        errors.append(abs(result.probes["root_moment"][-1] + arm))
    assert fitted_order([1 / n for n in SIZES], errors) > 1.9
    assert errors[0] < 1e-3
