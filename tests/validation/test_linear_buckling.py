"""Linear buckling against closed forms, and where it says that it cannot know."""

import der
import numpy as np
import pytest
from scenes import END, START, SUPPORTS, Scene, arch, straight, tip_force
from scipy.optimize import brentq
from scipy.special import jv

SIZES = [20, 40, 80]
STEPS = [1 / n for n in SIZES]

# A clamp that slides along the rod: a support and a spring far stiffer than the rod.
GUIDED = {**END, "fix": ["y"], "spring": {"rotational_stiffness": 1e9}}


def linear_buckling(scene: Scene, count: int = 3) -> der.Result:
    return der.run({**scene, "analysis": {"buckling": {"count": count}}})


def factors(scene: Scene, count: int = 3) -> np.ndarray:
    return linear_buckling(scene, count).buckling.load_factors


def clamped_pinned(order: int) -> float:
    """tan(u) = u, in the interval of that number."""
    u = brentq(lambda u: np.sin(u) - u * np.cos(u), order * np.pi, (order + 0.5) * np.pi)
    return u**2


def guided(n: int) -> Scene:
    scene = straight(n, "clamped-free", loads=tip_force(-1, 0))
    scene["supports"] = [*scene["supports"], GUIDED]
    return scene


def on_foundation(n: int) -> Scene:
    """A pinned column on a spring at each node, k = 1000 N/m per metre."""
    scene = straight(n, "pinned-pinned", loads=tip_force(-1, 0))
    springs = [
        {"rod": "rod", "at": {"node": i}, "spring": {"stiffness": [0, 1e3 / n]}}
        for i in range(1, n)
    ]
    scene["supports"] = [*scene["supports"], *springs]
    return scene


def drawn(points: list[list[float]], supports: list[Scene]) -> Scene:
    """A rod through points."""
    scene = straight(1, "free-free")
    rod = {k: v for k, v in scene["rods"][0].items() if k not in ("nodes", "from", "to")}
    return {**scene, "rods": [{**rod, "points": points}], "supports": supports}


def half_ring(n: int) -> Scene:
    """Half of a symmetric ring of radius 1; 1 N/m press it inwards and keep their direction."""
    angle = np.linspace(0, np.pi, n + 1)
    points = np.column_stack([np.cos(angle), np.sin(angle)])
    points[-1] = [-1, 0]
    scene = drawn(points.tolist(), [*SUPPORTS["clamped-free"], GUIDED])
    weight = np.full(n + 1, np.pi / n)
    weight[[0, -1]] /= 2
    scene["loads"] = [
        {"point_force": {"rod": "rod", "at": {"node": i}, "force": (-w * p).tolist()}}
        for i, (w, p) in enumerate(zip(weight, points, strict=True))
    ]
    return scene


def frame(n: int) -> Scene:
    """A column of length 1 under 1 N, stiffly joined to a beam of length 1; both ends pinned."""
    x = np.linspace(0, 1, n + 1)
    points = [[0.0, y] for y in x] + [[y, 1.0] for y in x[1:]]
    scene = drawn(points, [{**START, "fix": ["x", "y"]}, {**END, "fix": ["x", "y"]}])
    scene["loads"] = [{"point_force": {"rod": "rod", "at": 1.0, "force": [0, -1]}}]
    return scene


def frame_load() -> float:
    """The column's stiffness against turning at the joint, pinned at its foot, against 3 EI/L."""
    u = brentq(lambda u: u**2 * np.sin(u) + 3 * (np.sin(u) - u * np.cos(u)), np.pi, 4.49)
    return u**2


CASES = {
    "clamped-clamped": (guided, 4 * np.pi**2 * np.array([1, (8.986819 / 2 / np.pi) ** 2, 4])),
    "clamped-pinned": (
        lambda n: straight(n, "clamped-pinned", loads=tip_force(-1, 0)),
        np.array([clamped_pinned(i) for i in (1, 2, 3)]),
    ),
    "foundation": (
        on_foundation,
        np.sort([(m * np.pi) ** 2 + 1e3 / (m * np.pi) ** 2 for m in range(1, 20)])[:3],
    ),
    # Greenhill: the first zero of J_{-1/3}(2/3 sqrt(q)).
    "own weight": (
        lambda n: straight(n, "clamped-free", loads=[{"gravity": [-1, 0]}]),
        np.array([brentq(lambda q: jv(-1 / 3, 2 / 3 * np.sqrt(q)), 5, 10)]),
    ),
    # n^2 EI/R^3 with n = 2 waves, where the load keeps its direction (a pressure: n^2 - 1).
    "ring": (half_ring, np.array([4.0])),
    "frame": (frame, np.array([frame_load()])),
}


@pytest.mark.parametrize("case", CASES)
def test_critical_loads_at_second_order(fitted_order, case):
    make, exact = CASES[case]
    errors = [factors(make(n), len(exact)) / exact - 1 for n in SIZES]
    for of_mode in np.array(errors).T:
        assert fitted_order(STEPS, of_mode) > 1.9


def test_equal_columns_are_all_found():
    """Twenty equal columns and a longer one: each load occurs twenty times, each in its own rod."""
    scene = straight(20, "pinned-pinned", EA=1e6)
    names = ["rod", *(f"rod{i}" for i in range(1, 20))]
    rod, supports = scene["rods"][0], scene["supports"]
    scene["rods"] = [
        {**rod, "name": name, "from": [0, i], "to": [1, i]} for i, name in enumerate(names)
    ]
    scene["rods"].append({**rod, "name": "long", "from": [0, -1], "to": [2, -1], "nodes": 41})
    names.append("long")
    scene["supports"] = [{**support, "rod": name} for name in names for support in supports]
    scene["loads"] = [
        {"point_force": {"rod": name, "at": "end", "force": [-1, 0]}} for name in names
    ]
    found = linear_buckling(scene, 25).buckling
    first = 4 * 20**2 * np.sin(np.pi / 40) ** 2  # of the chain, exactly
    long = 4 * 20**2 * np.sin(np.array([1, 2, 3, 4]) * np.pi / 80) ** 2
    second = 4 * 20**2 * np.sin(np.pi / 20) ** 2
    exact = np.sort([*long, *[first] * 20, second])
    assert found.load_factors == pytest.approx(exact, rel=1e-7)
    assert np.linalg.matrix_rank(found.shapes.reshape(25, -1), tol=1e-3) == 25


@pytest.mark.parametrize("force", [1e-20, 1e-6, 1e6, 1e14, 1e30])
def test_loads_of_any_size(force):
    scene = straight(20, "pinned-pinned", EA=1e6, loads=tip_force(-force, 0))
    exact = 4 * 20**2 * np.sin(np.array([1, 2, 3]) * np.pi / 40) ** 2
    assert factors(scene) * force == pytest.approx(exact, rel=1e-9)


def test_rods_of_any_size():
    """An actin filament of 10 um under 1 N."""
    scene = straight(40, "pinned-pinned", loads=tip_force(-1, 0))
    section = {"stiffness": {"EA": 4e-8, "EI": 7e-26, "mass_per_length": 4e-14}}
    scene["rods"] = [{**scene["rods"][0], "to": [1e-5, 0], "cross_section": section}]
    euler = np.pi**2 * 7e-26 / 1e-5**2
    assert factors(scene) == pytest.approx(euler * np.array([1, 4, 9]), rel=6e-3)


ACROSS = {
    "across the tip": straight(50, "clamped-free", loads=tip_force(0, -1)),
    "across a beam": straight(
        50,
        "pinned-pinned",
        loads=[{"point_force": {"rod": "rod", "at": 0.75, "force": [0, -2000]}}],
    ),
    "moment": straight(50, "clamped-free", loads=[{"moment": {**END, "moment": 1.0}}]),
}


@pytest.mark.parametrize("oblique", [False, True])
@pytest.mark.parametrize("load", ACROSS)
def test_what_only_bends_has_no_factor_and_a_warning(load, oblique):
    """Taken along its deflection, the stiffness of these would vanish at spurious loads."""
    scene = ACROSS[load]
    if oblique:
        scene = turned(scene, 0.3)
    result = linear_buckling(scene)
    assert result.status == "completed"
    assert result.buckling is None
    (warning,) = result.summary["warnings"]
    assert "the loads bend the structure" in warning
    assert "analysis: continuation" in warning


def turned(scene: Scene, angle: float) -> Scene:
    """The same with rod and forces turned; a pin takes the place of a roller."""
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    loads = []
    for load in scene["loads"]:
        ((kind, what),) = load.items()
        if kind == "point_force":
            what = {**what, "force": (turn @ what["force"]).tolist()}
        loads.append({kind: what})
    rod = {**scene["rods"][0], "to": (turn @ [1, 0]).tolist()}
    supports = [
        {**support, "fix": ["x", "y"]} if "fix" in support else support
        for support in scene["supports"]
    ]
    return {**scene, "rods": [rod], "supports": supports, "loads": loads}


@pytest.mark.parametrize("edges", [50, 400])
def test_pulling_an_oblique_rod_never_buckles_it(edges):
    scene = turned(straight(edges, "clamped-free", loads=tip_force(1, 0)), 0.3)
    result = linear_buckling(scene)
    assert result.buckling is None
    (warning,) = result.summary["warnings"]
    assert "the loads cause tension" in warning


def test_a_column_that_stays_straight_needs_no_warning():
    result = linear_buckling(straight(20, "pinned-pinned", loads=tip_force(-1, 0)))
    assert result.summary["warnings"] == []
    assert result.buckling.rotations == pytest.approx(0, abs=1e-12)
    assert result.buckling.strains == pytest.approx(result.buckling.load_factors / 1e8)


def test_a_load_beside_the_axis_is_told_by_the_rotation():
    """Pressed with 1 N and bent by Q across its middle: Q L^2 / 16 EI is the turn at its ends."""
    across = 0.1
    loads = [
        *tip_force(-1, 0),
        {"point_force": {"rod": "rod", "at": "middle", "force": [0, -across]}},
    ]
    result = linear_buckling(straight(40, "pinned-pinned", loads=loads))
    factor = 4 * 40**2 * np.sin(np.array([1, 2, 3]) * np.pi / 80) ** 2
    assert result.buckling.load_factors == pytest.approx(factor, rel=1e-6)
    assert result.buckling.rotations == pytest.approx(factor * across / 16, rel=2e-3)
    (warning,) = result.summary["warnings"]
    assert f"turn by up to {result.buckling.rotations[0]:.2g} rad" in warning


@pytest.mark.parametrize("rise", [0.05, 0.1, 0.2])
def test_arches_that_give_way_first_are_told(rise):
    scene = arch(40, rise)
    result = linear_buckling(scene, 1)
    path = der.continuation(scene, to=40.0).path
    first = path.factor[path.rows("bifurcation")[0]]
    assert result.buckling.load_factors[0] / first > 1.05
    (warning,) = result.summary["warnings"]
    assert "deforms before it buckles" in warning
