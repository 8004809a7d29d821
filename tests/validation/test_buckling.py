"""Critical loads: linear buckling, and the bifurcations and branches of a continuation."""

import der
import numpy as np
import pytest
from scenes import buckled, straight, tip_force
from scipy import optimize, special

SIZES = [20, 40, 80]
ENDS = ["pinned-pinned", "clamped-free"]


@pytest.mark.parametrize("ends", ENDS)
def test_linear_buckling_loads_at_second_order(reference, fitted_order, ends):
    critical = reference("elastica", f"critical.{ends}")
    multiples = [1, 4, 9] if ends == "pinned-pinned" else [1, 9, 25]
    errors = []
    for n in SIZES:
        scene = straight(n, ends, loads=tip_force(-1, 0), analysis={"buckling": {"count": 3}})
        result = der.run(der.Scenario.from_dict(scene))
        assert result.summary["load_factors"] == result.buckling.load_factors.tolist()
        errors.append(result.buckling.load_factors / (critical * np.array(multiples)) - 1)
    for of_mode in np.array(errors).T:
        assert fitted_order([1 / n for n in SIZES], of_mode) > 1.9


def test_loads_that_pull_do_not_buckle_and_the_run_says_so():
    """Reversed they would: a sign that was not meant must not look like a safe structure."""
    scene = straight(20, "pinned-pinned", loads=tip_force(1, 0), analysis="buckling")
    result = der.run(der.Scenario.from_dict(scene))
    assert result.status == "completed"
    assert result.buckling is None
    assert result.summary["load_factors"] == []
    (warning,) = result.summary["warnings"]
    assert "with reversed signs they make the structure buckle" in warning


@pytest.mark.parametrize("force", [(0.0, 0.0), (0.0, -1.0)])
def test_no_factor_either_way_is_said_too(force):
    """A beam without loads, and one bent across, which has no tension to first order."""
    load = {"point_force": {"rod": "rod", "at": "middle", "force": list(force)}}
    scene = straight(20, "pinned-pinned", loads=[load], analysis="buckling")
    result = der.run(der.Scenario.from_dict(scene))
    assert result.summary["load_factors"] == []
    (warning,) = result.summary["warnings"]
    assert "make the structure buckle" not in warning
    assert ("bend the structure" if any(force) else "no part") in warning


@pytest.mark.parametrize("ends", ENDS)
def test_bifurcation_and_branches_of_a_column(reference, fitted_order, ends):
    critical = reference("elastica", f"critical.{ends}")
    at, exact = 1.5, reference("elastica", f"buckled.{ends}.1.5.deflection")
    factors, deflections = [], []
    for n in SIZES:
        scene = straight(n, ends, EA=1e7, loads=tip_force(-1, 0))
        result = der.continuation(scene, to=at * critical, branches=1)
        path = result.path
        (row,) = path.rows("bifurcation")
        factors.append(path.factor[row] / critical - 1)
        assert path.stable[(path.branch == 0) & (path.arc < path.arc[row])].all()
        assert path.branch.max() == 2
        ends_of = [np.flatnonzero(path.branch == b)[-1] for b in (1, 2)]
        assert path.stable[ends_of].all()
        aside = [result.positions[k, :, 1] for k in ends_of]
        assert aside[0] == pytest.approx(-aside[1], abs=1e-8)
        deflections.append(np.abs(aside[0]).max() - exact)
    sizes = [1 / n for n in SIZES]
    assert fitted_order(sizes, factors) > 1.9
    assert fitted_order(sizes, deflections) > 1.9


def elastica(shortening):
    """Load and rise of an inextensible pinned column, EI = L = 1, whose ends come nearer by
    `shortening`: with modulus k, the ends are 2 E(k) / K(k) - 1 apart, the load is (2 K(k))^2 and
    the rise k / K(k) (Love, A Treatise on the Mathematical Theory of Elasticity, section 263). A
    clamped column rises as much, under four times the load.
    """
    m = optimize.brentq(
        lambda m: 2 * special.ellipe(m) / special.ellipk(m) - 2 + shortening, 1e-9, 1 - 1e-9
    )
    return 4 * special.ellipk(m) ** 2, np.sqrt(m) / special.ellipk(m)


@pytest.mark.parametrize("EA", [1e4, 1e6, 1e8, 1e10])
@pytest.mark.parametrize("ends", ["pinned-pinned", "clamped-clamped"])
def test_columns_pushed_together_bow_in_one_arc(ends, EA):
    """However stiff against shortening: crushed first, they would fold in a high mode and stay so.

    With 10 edges the whole motion, 0.1, would put the end onto its neighbour.
    """
    for shortening in (0.01, 0.1, 0.3):
        for n in (10, 40):
            scene = straight(n, ends, EA=EA)
            support = dict(scene["supports"][1])
            support["prescribe"] = {"x": -shortening}
            scene["supports"] = [scene["supports"][0], support]
            simulation = der.Simulation(der.Scenario.from_dict(scene))
            assert simulation.equilibrium().stability == "stable"
            rise = np.abs(simulation.positions[:, 1]).max()
            # Compression takes the strain P / EA off the shortening: at EA = 1e4 up to two fifths
            # of 0.01.
            load, _ = elastica(shortening)
            strain = load * (4 if ends == "clamped-clamped" else 1) / EA
            _, exact = elastica(shortening - strain)
            assert rise == pytest.approx(exact, rel=1.2 / n**2)


def test_a_clamped_column_buckles_as_its_end_moves(reference, fitted_order):
    """The path along a prescribed motion: the column is pressed evenly until it bifurcates."""
    critical = reference("frequencies", "loaded.clamped-clamped.critical")
    shortening, EA = 0.01, 1e4
    errors = []
    for n in SIZES:
        scene = buckled(n, "clamped", shortening, EA)
        del scene["loads"]
        path = der.continuation(scene, vary="supports").path
        first = path.rows("bifurcation")[0]
        errors.append(path.factor[first] * shortening * EA / critical - 1)
    assert fitted_order([1 / n for n in SIZES], errors) > 1.9
