"""Critical loads: linear buckling, and the bifurcations and branches of a continuation."""

import der
import numpy as np
import pytest
from scenes import buckled, straight, tip_force

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


def test_loads_that_pull_do_not_buckle():
    scene = straight(20, "pinned-pinned", loads=tip_force(1, 0), analysis="buckling")
    result = der.run(der.Scenario.from_dict(scene))
    assert result.status == "completed"
    assert result.buckling is None


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
