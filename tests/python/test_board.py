"""The solver of the public score board: der.board."""

import importlib.metadata
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

board = pytest.importorskip("cosseratbench")

from cosseratbench import registry  # noqa: E402
from cosseratbench.scenario import (  # noqa: E402
    End,
    EndCondition,
    Material,
    Motion,
    Plane,
    PointLoad,
    Rod,
    Scenario,
)
from der.board import Solver  # noqa: E402

ROUND = Material(youngs_modulus=1e6, shear_modulus=4e5, density=1000.0)
FREE, PINNED, CLAMPED = EndCondition.FREE, EndCondition.PINNED, EndCondition.CLAMPED
STRAIGHT = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))


def rod(centerline=STRAIGHT, **changes):
    return Rod(centerline, radius=0.02, material=ROUND, **changes)


def run(*rods, n_elements=10, n_frames=3, duration=1.0, **changes):
    scenario = Scenario(rods, duration=duration, **changes)
    return Solver().run(scenario, n_elements=n_elements, n_frames=n_frames)


def moving(displacement=(0.0, 0.0, 0.0), rotation=(0.0, 0.0, 0.0), slides_along=None):
    """To there in half a second."""
    still = (0.0, 0.0, 0.0)
    return Motion((0.0, 0.5), (still, displacement), (still, rotation), slides_along)


def rotation_about_x(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def test_the_board_finds_it():
    (entry,) = importlib.metadata.entry_points(group=registry.SOLVERS, name="der")
    assert entry.load() is Solver
    assert isinstance(Solver(), board.Solver)
    assert Solver.backend_version == importlib.metadata.version("der")


# With the board's own numbers of elements. That of the cantilever is the error of linear theory,
# which is the reference. The reference of the catenary leaves out bending, worth 3.8e-4 of the sag.
@pytest.mark.parametrize(
    ("name", "metric", "largest"),
    [
        ("cantilever", "tip_deflection_error", 4.1e-4),
        ("catenary", "sag_error", 1.8e-4),
        ("catenary", "shape_error", 4.7e-4),
        ("pendulum", "period_error", 1.3e-5),
        ("pendulum", "amplitude_change", 1e-4),
        ("twist", "critical_twist_error", 1.6e-3),
    ],
)
def test_its_errors_on_the_board(name, metric, largest):
    result = board.run(registry.load_experiment(name), Solver())
    assert result.outcome == "completed"
    assert abs(result.metrics[metric]) <= largest


@pytest.mark.parametrize("name", ["crossing", "capstan", "pile"])
def test_contact_is_unsupported(name):
    assert board.run(registry.load_experiment(name), Solver()).outcome == "unsupported"


def test_obstacles_are_refused_in_a_direct_call_too():
    floor = Plane(point=(0.0, 0.0, -1.0), normal=(0.0, 0.0, 1.0))
    with pytest.raises(NotImplementedError, match="contact with obstacles"):
        run(rod(start=CLAMPED), obstacles=(floor,))


@pytest.mark.parametrize("quasi_static", [True, False])
@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.0, 1.0, 1.0)])
def test_frames_begin_with_the_start_and_directors_turn_with_the_rod(quasi_static, normal):
    # A drawn quarter of a circle, straight without stress.
    angle = np.linspace(0.0, np.pi / 2, 101)
    arc = np.stack([np.sin(angle), np.zeros_like(angle), 1.0 - np.cos(angle)], axis=1)
    bent = rod(tuple(map(tuple, arc)), normal=normal, start=CLAMPED)
    found = run(bent, n_frames=5, gravity=(0.0, 0.0, -9.81), quasi_static=quasi_static)
    (nodes,), (directors,) = found.positions, found.directors
    assert found.times == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])
    np.testing.assert_allclose(nodes[0], bent.nodes(10), atol=1e-14)
    np.testing.assert_allclose(directors[0], bent.directors(10), atol=1e-12)
    tangents = np.diff(nodes, axis=1)
    tangents /= np.linalg.norm(tangents, axis=2, keepdims=True)
    np.testing.assert_allclose(np.linalg.norm(directors, axis=2), 1.0, atol=1e-12)
    np.testing.assert_allclose(np.sum(directors * tangents, axis=2), 0.0, atol=1e-12)
    # In a plane the part of a director across the plane stays, and its part along the edge's
    # normal is that of the start.
    np.testing.assert_allclose(directors[..., 1], directors[:1, ..., 1] + 0 * nodes[:, 1:, 1])
    across = np.stack([-tangents[..., 2], tangents[..., 0]], axis=2)
    along = np.sum(across * directors[..., [0, 2]], axis=2)
    np.testing.assert_allclose(along, along[:1] + 0 * along, atol=1e-12)
    assert np.abs(nodes[-1] - nodes[0]).max() > 0.1


@pytest.mark.parametrize(
    ("held", "motion"),
    [
        ({"start": CLAMPED}, {}),
        ({"end": CLAMPED}, {}),
        ({"start": PINNED}, {}),
        ({"start": CLAMPED}, {"start_motion": moving((0.0, 0.0, 0.05), (0.0, 0.8, 0.0))}),
        ({"start": CLAMPED, "end": PINNED}, {}),
    ],
)
def test_a_motion_in_a_plane_is_the_same_in_space(held, motion):
    """Turned about x, the scenario is no longer in a plane of two axes."""
    turn = rotation_about_x(0.5)

    def turned(vectors):
        return tuple(map(tuple, np.asarray(vectors) @ turn.T))

    weight, force = np.array([0.0, 0.0, -9.81]), np.array([0.0, 0.0, -0.01])
    flat = rod(normal=(0.0, 1.0, 1.0), loads=(PointLoad(tuple(force)),), **held, **motion)
    askew = {
        name: replace(one, displacement=turned(one.displacement), rotation=turned(one.rotation))
        for name, one in motion.items()
    }
    other = replace(
        flat,
        normal=tuple(turn @ flat.normal),
        loads=(PointLoad(tuple(turn @ force)),),
        **askew,
    )
    frames = {"n_frames": 21, "duration": 0.4}
    planar = run(flat, **frames, gravity=tuple(weight))
    spatial = run(other, **frames, gravity=tuple(turn @ weight))
    np.testing.assert_allclose(spatial.positions[0], planar.positions[0] @ turn.T, atol=1e-7)
    np.testing.assert_allclose(spatial.directors[0], planar.directors[0] @ turn.T, atol=1e-6)
    assert np.abs(planar.positions[0][-1] - planar.positions[0][0]).max() > 1e-3


def test_a_clamp_that_turns_twists_the_rod():
    twisted = rod(start=CLAMPED, end=CLAMPED, end_motion=moving(rotation=(1.5, 0.0, 0.0)))
    found = run(twisted, quasi_static=True, duration=6.0)
    angles = np.arctan2(-found.directors[0][-1, :, 1], found.directors[0][-1, :, 2])
    np.testing.assert_allclose(angles, 1.5 * (np.arange(10) + 0.5) / 10, atol=1e-4)
    np.testing.assert_allclose(found.positions[0][-1], twisted.nodes(10), atol=1e-12)


@pytest.mark.parametrize("sliding", [End.START, End.END])
def test_a_clamp_that_slides_is_pulled_by_its_load(sliding):
    motion = moving(rotation=(1.5, 0.0, 0.0), slides_along=(1.0, 0.0, 0.0))
    pull = 3.0 if sliding is End.END else -3.0
    pulled = rod(
        start=CLAMPED,
        end=CLAMPED,
        loads=(PointLoad((pull, 0.0, 0.0), at=sliding),),
        **{f"{sliding.value}_motion": motion},
    )
    found = run(pulled, quasi_static=True, duration=20.0)
    ends = found.positions[0][-1][[0, -1], 0]
    stretched = 3.0 / (1e6 * pulled.area)
    np.testing.assert_allclose(ends[1] - ends[0], 1.0 + stretched, rtol=1e-6)
    still = 0 if sliding is End.END else 1
    assert ends[still] == pytest.approx(float(still), abs=1e-12)


def test_a_clamp_that_slides_falls_by_its_weight():
    """Both ends slide in the plane of the rod: it falls freely, with its inertia."""
    motion = moving(slides_along=(0.0, 0.0, 1.0))
    falling = rod(start=CLAMPED, end=CLAMPED, start_motion=motion, end_motion=motion)
    found = run(falling, gravity=(0.0, 0.0, -9.81), duration=0.3, n_frames=11)
    np.testing.assert_allclose(found.positions[0][-1][:, 2], -0.5 * 9.81 * 0.3**2, rtol=1e-6)


def unevenly_stretched(**held):
    points = ((0.0, 0.0, 0.0), (0.6, 0.0, 0.0), (1.0, 0.0, 0.0))
    return rod(points, rest_arc_length=(0.0, 0.5, 1.0), **held)


def test_a_rod_may_start_unevenly_stretched():
    drawn = unevenly_stretched(start=CLAMPED)
    found = run(drawn, quasi_static=True)
    np.testing.assert_allclose(found.positions[0][0], drawn.nodes(10), atol=1e-14)
    np.testing.assert_allclose(found.positions[0][-1], rod().nodes(10), atol=1e-9)


ASKEW = moving(slides_along=(1.0, 1.0, 0.0))


@pytest.mark.parametrize(
    ("held", "scenario", "words"),
    [
        ({"end_motion": ASKEW, "start": CLAMPED}, {"quasi_static": True}, "askew to the axes"),
        (
            {
                "end_motion": Motion(
                    (0.0, 1.0, 2.0),
                    ((0.0, 0.0, 0.0),) * 3,
                    ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
                )
            },
            {},
            "turns about several axes",
        ),
    ],
)
def test_what_it_cannot_say_is_named(held, scenario, words):
    with pytest.raises(NotImplementedError, match=words):
        run(rod(**{"end": CLAMPED, **held}), **scenario)


def test_a_bent_rod_held_at_both_ends_has_to_start_evenly_stretched():
    angle = np.linspace(0.0, 1.0, 21)
    arc = np.stack([np.sin(angle), np.zeros(21), 1.0 - np.cos(angle)], axis=1)
    uneven = rod(
        tuple(map(tuple, arc)), rest_arc_length=tuple(angle**1.2), start=CLAMPED, end=CLAMPED
    )
    with pytest.raises(NotImplementedError, match="bent and unevenly stretched"):
        run(uneven)


def test_a_run_that_fails_has_diverged():
    # Nothing holds it against its weight.
    with pytest.raises(board.solver.Diverged):
        run(rod(), quasi_static=True, gravity=(0.0, 0.0, -9.81))


def test_the_time_step_is_an_option_and_told():
    swinging = registry.load_experiment("pendulum").scenario
    asked = {"n_elements": 10, "n_frames": 3}
    told = Solver().settings(swinging, **asked)
    assert told["method"] == "run over time"
    assert told["damping_rate"] == 0.0
    halved = Solver(time_step_scale=0.5).settings(swinging, **asked)
    assert halved["time_step"] == pytest.approx(told["time_step"] / 2, rel=0.1)
    still = registry.load_experiment("cantilever").scenario
    assert Solver().settings(still, **asked) == {"method": "equilibrium"}


def test_the_benchmark_prints_the_scores(capsys, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "benchmarks"))
    import board as program

    monkeypatch.setattr(program, "use_one_core", lambda: None)
    file = tmp_path / "scores.csv"
    assert program.main(["cantilever", "crossing", "--solvers", "der", "--csv", str(file)]) == 0
    lines = capsys.readouterr().out.splitlines()
    version = importlib.metadata.version("der")
    assert f"| experiment | elements | | der {version} |" in lines
    assert "| cantilever | 20 | tip deflection error | 4.1e-04 |" in lines
    assert "| crossing | 51 | CPU time | needs rod_contact |" in lines
    assert "tip_deflection_error" in file.read_text(encoding="utf-8")
    sys.modules.pop("board")
