"""Snap-through of arches and buckled beams: limit points, bifurcations and whole curves.

References: `references/arch.py`, continuation of the continuum by collocation; for counts
`chain.py`, the same chain of bars and hinges followed by other means.
"""

from pathlib import Path

import der
import numpy as np
import pytest
from chain import pinned_chain
from scenes import arch, buckled

COLUMN = Path(__file__).resolve().parents[2] / "configs/euler_buckling.yaml"
SIZES = [20, 40, 80]
FINE = [80, 160, 320]  # for the sharp shapes of a pushed buckled beam


def events(reference, problem, kind, count):
    return [reference("arch", f"{problem}.{kind}.{i}.load") for i in range(1, count + 1)]


def check_second_order(found, exact, fitted_order, sizes=SIZES):
    errors = np.array(found) - np.array(exact)
    for of_event in errors.T:
        assert fitted_order([1 / n for n in sizes], of_event) > 1.9


@pytest.mark.parametrize(("rise", "bifurcations"), [(0.03, 0), (0.05, 2)])
def test_arch(reference, fitted_order, rise, bifurcations):
    problem = f"arch.rise{rise}"
    folds, crossings = [], []
    for n in SIZES:
        path = der.continuation(arch(n, rise), to=8.0).path
        folds.append(path.factor[path.rows("fold")])
        crossings.append(path.factor[path.rows("bifurcation")])
    check_second_order(folds, events(reference, problem, "limits", 2), fitted_order)
    exact = events(reference, problem, "bifurcations", bifurcations)
    check_second_order(crossings, exact, fitted_order)


def test_arch_follows_the_whole_curve(reference):
    """Every reference point of the S-shaped curve lies on ours."""
    result = der.continuation(arch(160, 0.05), to=8.0, step=0.01, points=2000)
    drop = 0.05 - np.asarray(result.probes["middle"])
    loads = np.array(reference("arch", "arch.rise0.05.path.load"))
    drops = np.array(reference("arch", "arch.rise0.05.path.drop"))
    inside = drops <= drop.max()
    assert inside.sum() > 30
    ours = np.interp(drops[inside], drop, result.path.factor)
    assert ours == pytest.approx(loads[inside], abs=0.01)


def test_arch_of_rise_0_05_has_skew_branches_between_its_bifurcations():
    result = der.continuation(arch(40, 0.05), to=8.0, branches=1)
    path = result.path
    first, last = path.factor[path.rows("bifurcation")]
    y = result.positions[:, :, 1]
    skew = np.abs(y - y[:, ::-1]).max(axis=1)
    assert skew[path.branch == 0].max() < 1e-6
    # A loop through both bifurcations, where its load is greatest and least.
    for branch in (1, 2):
        on_branch = path.branch == branch
        assert skew[on_branch].max() > 0.01
        assert path.factor[on_branch].max() == pytest.approx(first, abs=1e-3)
        assert path.factor[on_branch].min() == pytest.approx(last, abs=1e-2)


def crossings(path, load):
    """Rows of a path just before it passes a load."""
    step = np.sign(path.factor - load)
    return np.flatnonzero((step[1:] != step[:-1]) & (path.branch[1:] == path.branch[:-1]))


@pytest.mark.parametrize("node", [10, 9])
def test_each_event_and_each_equilibrium_of_an_arch_is_found_once(node):
    """Pressed at the middle, and beside it, where the imperfect arch has no bifurcation.

    Both counts are those of `chain.py`: the events along its path, and the different equilibria
    under one load between the limits that Newton finds from 200 shapes.
    """
    load = 3.0
    scene = arch(20, 0.05)
    scene["loads"][0]["point_force"]["at"] = {"node": node}
    path = der.continuation(scene, to=8.0, branches=1).path
    chain = pinned_chain(np.array(scene["rods"][0]["points"]), 1e4, 1.0, {node: (0.0, -1.0)})

    exact = chain.follow(8.0, step=0.008, scale=20.0).events()
    rows = np.flatnonzero(path.events)
    assert list(path.events[rows]) == [kind for kind, _ in exact]
    # Its points are up to 0.15 apart in the load.
    assert path.factor[rows] == pytest.approx([at for _, at in exact], abs=0.16)

    x = chain.points[1:-1, 0]
    starts = []
    for weights in np.random.default_rng(1).uniform(-1.0, 1.0, (200, 3)):
        shape = chain.points.copy()
        for wave, height in enumerate(weights * [0.1, 0.075, 0.025], 1):
            shape[1:-1, 1] += height * np.sin(wave * np.pi * x)
        starts.append(shape.ravel()[chain.free])
    equilibria = chain.equilibria(load, starts)
    assert len(equilibria) == 5
    assert len(crossings(path, load)) == 5


@pytest.mark.parametrize(
    ("scene", "to", "branches"),
    [
        (arch(40, 0.05), 8.0, {0: -1, 1: 0, 2: 0}),
        # The skew branch meets the symmetric shapes of the arch turned over, and closes.
        (arch(80, 0.1), 30.0, {0: -1, 1: 0, 2: 1, 3: 1}),
        (arch(320, 0.1), 30.0, {0: -1, 1: 0, 2: 1, 3: 1}),
        (arch(40, 0.17), 255.0, {0: -1, **dict.fromkeys(range(1, 9), 0)}),
        (buckled(80, "pinned"), 40.0, {0: -1, **dict.fromkeys(range(1, 5), 0)}),
        (buckled(80, "clamped"), 40.0, {0: -1, 1: 0, 2: 0}),
    ],
)
def test_no_path_is_followed_twice(scene, to, branches):
    """Nor do two events lie at one place, however fine the mesh: where a branch passes through a
    bifurcation, rounding makes the place at which its stiffness is singular a stretch.
    """
    result = der.continuation(scene, to=to, branches=2, points=2000)
    path = result.path
    found = [branch["parent"] for branch in result.summary["path"]["branches"]]
    assert dict(enumerate(found)) == branches
    assert len(result.summary["path"]["events"]) == np.count_nonzero(path.events)
    shapes = result.positions.reshape(len(path.factor), -1)
    met = np.flatnonzero(path.events)
    for i, row in enumerate(met):
        for other in met[:i]:
            apart = np.abs(shapes[row] - shapes[other]).max()
            assert apart > 1e-4, (path.factor[row], path.events[[row, other]])
    # A point of each branch, away from its ends, lies on no other.
    for branch in branches:
        rows = np.flatnonzero(path.branch == branch)
        point = shapes[rows[len(rows) // 3]]
        for other in set(branches) - {branch}:
            line = shapes[path.branch == other]
            assert distance_to_line(point, line) > 1e-4


def distance_to_line(point, line):
    """From a polyline, its rows being points."""
    step = np.diff(line, axis=0)
    gap = point - line[:-1]
    along = np.clip(np.sum(gap * step, axis=1) / np.maximum(np.sum(step**2, axis=1), 1e-300), 0, 1)
    return np.linalg.norm(gap - along[:, np.newaxis] * step, axis=1).min()


# Between the limits of the clamped beam are the folds of the next test.
@pytest.mark.parametrize(("ends", "limits"), [("clamped", [0, -1]), ("pinned", [0, 1, 2, 3])])
def test_pushed_buckled_beam(reference, fitted_order, ends, limits):
    problem = f"buckled.{ends}.shortening0.02"
    folds, crossings = [], []
    for n in FINE:
        path = der.continuation(buckled(n, ends), to=40.0, points=2000).path
        folds.append(path.factor[path.rows("fold")][limits])
        crossings.append(path.factor[path.rows("bifurcation")][:1])
    check_second_order(folds, events(reference, problem, "limits", len(limits)), fitted_order, FINE)
    check_second_order(crossings, events(reference, problem, "bifurcations", 1), fitted_order, FINE)


@pytest.mark.parametrize("steps", [{}, {"step": 0.01}])
def test_clamped_beam_loses_its_symmetry_under_half_a_turn(reference, fitted_order, steps):
    """A bifurcation between the limits, to shapes that are still symmetric about the middle.

    In the chain a clamp and the middle under its load differ by order 2 in the element length,
    which disturbs the crossing: the path turns off to one side at a fold, whose load is off by the
    disturbance to the power 2/3, order 4/3. Long steps could go straight across, and must not.
    """
    problem = "buckled.clamped.shortening0.02"
    exact = events(reference, problem, "symmetric_bifurcations", 2)
    assert exact[0] == pytest.approx(-exact[1], abs=1e-9)
    errors = []
    for n in FINE:
        path = der.continuation(buckled(n, "clamped"), to=40.0, points=2000, **steps).path
        limit, first, second, last = path.rows("fold")
        assert path.factor[limit] == pytest.approx(-path.factor[last], abs=1e-6)
        assert path.factor[first] == pytest.approx(-path.factor[second], abs=1e-6)
        assert list(path.unstable_directions[[limit - 1, limit, first]]) == [1, 2, 3]
        errors.append(path.factor[second] - exact[0])
    assert fitted_order([1 / n for n in FINE], errors) == pytest.approx(4 / 3, abs=0.15)


def test_long_steps_stay_on_the_path():
    """An arch so high that mirrored sheets of its path are nearer than the next point.

    The events are those that `chain.py` meets in short steps.
    """
    scene = arch(20, 0.17)
    chain = pinned_chain(np.array(scene["rods"][0]["points"]), 1e4, 1.0, {10: (0.0, -1.0)})
    exact = chain.follow(255.0, step=0.01, scale=200.0).events()
    found = []
    for steps in ({}, {"step": 5e-3}):
        path = der.continuation(scene, to=255.0, points=4000, **steps).path
        met = np.flatnonzero(path.events != "")
        found.append((list(path.events[met]), path.factor[met]))
    # It cannot tell the order of a fold and a bifurcation that are met in one of its steps.
    assert sorted(found[0][0]) == sorted(kind for kind, _ in exact)
    assert found[0][0] == found[1][0]
    assert found[0][1] == pytest.approx(found[1][1], abs=1e-4)


@pytest.mark.parametrize("curvature", [1e-2, 1e-4, 1e-8])
def test_an_imperfect_column_has_no_bifurcation(curvature):
    """It bends to one side from the start; a step straight across to the other would find one."""
    column = der.load(COLUMN, **{"rods.column.natural_curvature": curvature})
    path = der.continuation(column).path
    assert not (path.events != "").any()
    assert not path.unstable_directions.any()
