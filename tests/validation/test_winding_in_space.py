"""Turns of rods in space that a program writes: the equilibria that it read, torque and energy.

Read are equilibria to which one simulation came in small steps of its clamps, so that no turn is
in doubt. They are written into another one, whose clamps are turned from the start. Straight rods
have the exact torque GJ T/L and energy GJ T^2/(2 L) of a twist T.
"""

import itertools

import der
import numpy as np
import pytest
from scenes import Scene

START, END = {"rod": "rod", "at": "start"}, {"rod": "rod", "at": "end"}
STIFF = {"EA": 1e4, "EI1": 1.0, "EI2": 1.3, "GJ": 1.0, "mass_per_length": 1.0}
LINE = {"nodes": 41, "from": [0, 0, 0], "to": [1, 0, 0]}
ANGLES = ("angles", "alone")
AXES = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1], "oblique": [0.3, -0.5, 0.8]}


def turned(axis, angle, twist=0.0, x=-0.1) -> Scene:
    return {"x": x, "rotation": {"axis": axis, "angle": angle}, "twist": twist}


def held(end, start=None, more=(), stiff=None, rod=None, force=(0, 0.5, 0.3)) -> Scene:
    """A rod clamped at both ends, with a force at 0.4 that tells its sides apart."""
    section = {"stiffness": {**STIFF, **(stiff or {})}}
    torque = {"rod": "rod", "at": 0.4, "quantity": "torque"}
    return {
        "model": "spatial",
        "rods": [{"name": "rod", **(rod or LINE), "cross_section": section}],
        "supports": [
            {**START, **(start or {"clamp": True})},
            {**END, "clamp": True, "prescribe": end},
            *more,
        ],
        "loads": [{"point_force": {"rod": "rod", "at": 0.4, "force": list(force)}}],
        "analysis": "static",
        "output": {"probes": {"torque": torque, "energy": {"quantity": "elastic_energy"}}},
    }


def begun(scene) -> Scene:
    """The same with its clamps as they are drawn."""

    def at_zero(values):
        return {
            key: {**value, "angle": 0.0} if key == "rotation" else 0.0
            for key, value in values.items()
        }

    supports = [
        {**support, "prescribe": at_zero(support["prescribe"])}
        if "prescribe" in support
        else support
        for support in scene["supports"]
    ]
    return {**scene, "supports": supports}


def turn_by_steps(scene, largest=0.5):
    """A simulation that came to the equilibrium of a scene in small steps of its clamps [rad]."""
    simulation = der.Simulation(begun(scene))
    motions = {}
    for number, support in enumerate(scene["supports"]):
        values = dict(support.get("prescribe", {}))
        rotation = values.pop("rotation", None)
        motions[number] = values | ({"angle": rotation["angle"]} if rotation else {})
    farthest = max(abs(value) for values in motions.values() for value in values.values())
    count = int(np.ceil(farthest / largest))
    for share in np.arange(1, count + 1) / count:
        for number, values in motions.items():
            if values:
                simulation.prescribe(number, **{key: share * to for key, to in values.items()})
        simulation.equilibrium()
    return simulation


def write(read, simulation, how):
    simulation.positions[...] = read.positions
    if how == "angles":
        simulation.theta[...] = read.theta


def check_the_same(found, expected):
    for name in ("torque", "energy"):
        assert found.probes[name] == pytest.approx(expected.probes[name], rel=1e-6, abs=1e-6)
    assert found.positions == pytest.approx(expected.positions, abs=1e-7)


def check_kept(scene):
    read = turn_by_steps(scene)
    for how in ANGLES:
        simulation = der.Simulation(scene)
        write(read, simulation, how)
        simulation.equilibrium()
        check_the_same(simulation, read)


@pytest.mark.filterwarnings("ignore:.*too coarse for the twist")
@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("twist", [0.0, 7.0, 30.0])
def test_an_equilibrium_that_a_program_writes_is_kept(axis, twist):
    """Its clamp is turned by up to three turns, about any axis, and about the tangent besides."""
    for angle in (3.0, 6.5, 8.0, -12.0, 20.0):
        check_kept(held(turned(AXES[axis], angle, twist)))


OBLIQUE = turned(AXES["oblique"], 8.0, 2.0)
SPRING = {"rotational_stiffness": [3.0, 3.0, 2.0]}
BENT = [[min(s, 0.5), max(s - 0.5, 0), 0] for s in np.linspace(0, 1, 41).tolist()]
COIL = [[0.3 * np.cos(t), 0.3 * np.sin(t), 0.1 * t] for t in np.linspace(0, 5, 61).tolist()]
PINNED = {"fix": ["x", "y", "z"]}
KINDS = {
    "strip": held(OBLIQUE, stiff={"EI2": 30.0}),
    "drawn with twist": held(OBLIQUE, rod={**LINE, "initial_twist": 5.0}),
    "natural twist": held(
        OBLIQUE,
        rod={**LINE, "natural_twist": 9.0, "natural_curvature": [1, 2]},
    ),
    "both clamps": held(OBLIQUE, {"clamp": True, "prescribe": turned([0, 1, 0], -4.0, 3.0, 0.0)}),
    "pinned": held(OBLIQUE, PINNED),
    "spring at its end": held(turned(AXES["oblique"], 3.0, 20.0), {**PINNED, "spring": SPRING}),
    "spring inside": held(OBLIQUE, more=[{"rod": "rod", "at": 0.63, "spring": SPRING}]),
    "clamp inside": held(
        OBLIQUE,
        more=[
            {"rod": "rod", "at": 0.5, "clamp": True, "prescribe": turned([0, 1, 0], 2.0, -4.0, 0.0)}
        ],
    ),
    "corner": held(turned(AXES["oblique"], 6.5), rod={"points": BENT}),
    "coil": held(turned(AXES["oblique"], 3.0, 8.0), rod={"points": COIL}),
}


@pytest.mark.parametrize("kind", KINDS)
def test_it_is_kept_whatever_the_rod(kind):
    check_kept(KINDS[kind])


@pytest.mark.parametrize("node", [0, 7])
@pytest.mark.parametrize("angle", [3.0, 2 * np.pi, 8.0])
def test_a_ring_that_a_program_writes_is_kept(node, angle):
    """Clamped at two nodes, as Goto's is: the ring may begin at a clamp or between two."""
    around = np.arange(40) * 2 * np.pi / 40
    points = np.column_stack([np.cos(around), np.sin(around), 0 * around]) / (2 * np.pi)
    scene = held(OBLIQUE, rod={"closed": True, "points": points.tolist()})
    turning = {"rotation": {"axis": [1, 0, 0], "angle": angle}, "twist": 3.0}
    scene["supports"] = [
        {"rod": "rod", "at": {"node": node}, "clamp": True},
        {"rod": "rod", "at": {"node": node + 20}, "clamp": True, "prescribe": turning},
    ]
    scene["loads"][0]["point_force"]["at"] = {"node": 11}
    scene["output"]["probes"]["torque"]["at"] = 0.2
    check_kept(scene)


@pytest.mark.parametrize(
    ("end", "turns"),
    [
        (turned([1, 0, 0], 7.0, -3.0, x=0.01), [4.0, 4.0 + 2 * np.pi, 4.0 - 6 * np.pi]),
        (turned([0, 0, 1], 2 * np.pi, x=0.01), [-2 * np.pi, 2 * np.pi, 6 * np.pi]),
        (turned([0, 0, 1], 4 * np.pi, 1.0, x=0.01), [1.0, 1.0 + 4 * np.pi, 1.0 - 2 * np.pi]),
    ],
)
def test_angles_that_a_program_writes_tell_the_turns_of_a_straight_rod(end, turns):
    """Any number of turns that fit its clamps; without angles what these have turned it by."""
    scene = held(end, stiff={"EA": 1e6, "EI2": 1.0, "GJ": 0.7}, force=(0, 0, 0))
    middles = (np.arange(40) + 0.5) / 40
    for twist, how in (*zip(turns, itertools.repeat("angles")), (turns[0], "alone")):
        simulation = der.Simulation(scene)
        simulation.positions[:, 0] *= 1.01
        if how == "angles":
            simulation.theta[...] = twist * middles
        assert simulation.equilibrium().stability == "stable"
        sign = np.sign(simulation.probes["torque"]) if how == "alone" else np.sign(twist)
        assert sign * simulation.probes["torque"] == pytest.approx(0.7 * abs(twist), rel=1e-9)
        energy = 0.5 * 0.7 * twist**2 + 0.5 * 1e6 * 0.01**2
        assert simulation.probes["energy"] == pytest.approx(energy, rel=1e-9)


@pytest.mark.parametrize("how", ANGLES)
def test_it_is_kept_wherever_a_program_writes_it(how):
    """Into a batch, through a saved state, into a simulation that was wound otherwise."""
    scene = held(OBLIQUE)
    read = turn_by_steps(scene)
    batch = der.Batch(scene, 2, 1)
    batch.positions[1] = read.positions
    if how == "angles":
        batch.theta[1] = read.theta
    batch.equilibrium()
    assert batch.positions[1] == pytest.approx(read.positions, abs=1e-9)

    written, restored = der.Simulation(scene), der.Simulation(scene)
    write(read, written, how)
    restored.restore_state(written.save_state())
    restored.equilibrium()
    check_the_same(restored, read)

    other = der.Simulation(scene)
    other.equilibrium()
    other.prescribe(1, x=-0.2, angle=3.0, twist=-4.0)
    other.equilibrium()
    write(read, other, how)
    other.prescribe(1, x=-0.1, angle=8.0, twist=2.0)
    other.equilibrium()
    check_the_same(other, read)


@pytest.mark.parametrize("how", ANGLES)
def test_saved_results_are_kept(how):
    """Those of a static run, and points of a path."""
    path = der.continuation(held(OBLIQUE), vary="supports", step=0.05, points=90)
    middle = int(np.argmax(path.path.factor > 0.7))
    assert path.path.stable[middle]
    share = path.path.factor[middle]
    on_the_way = turned(AXES["oblique"], 8.0 * share, 2.0 * share, -0.1 * share)
    run = der.run(held(OBLIQUE))
    for result, frame, scene in ((run, -1, held(OBLIQUE)), (path, middle, held(on_the_way))):
        simulation = der.Simulation(scene)
        simulation.positions[...] = result.positions[frame]
        if how == "angles":
            simulation.theta[...] = result.theta[frame]
        simulation.equilibrium()
        assert simulation.positions == pytest.approx(result.positions[frame], abs=1e-9)
        energy = result.probes["energy"][frame]
        assert simulation.probes["energy"] == pytest.approx(energy, rel=1e-9)


@pytest.mark.parametrize("twist", [0.0, 5.0])
@pytest.mark.parametrize("angle", [6.5, 8.0])
def test_a_clamp_that_a_program_turns_at_once_winds_the_rod(angle, twist):
    """From an equilibrium on, as in small steps, even where it says so in two."""
    scene = held(turned(AXES["oblique"], angle, twist))
    expected = turn_by_steps(scene)
    simulation = der.Simulation(begun(scene))
    simulation.equilibrium()
    simulation.prescribe(1, x=-0.1, angle=0.5 * angle, twist=twist)
    simulation.prescribe(1, angle=angle)
    simulation.equilibrium()
    check_the_same(simulation, expected)


def test_angles_of_an_equilibrium_as_it_is_drawn_stay():
    """Their frames are the drawn ones: those of a coil, which twists as it is drawn."""
    scene = held(turned([1, 0, 0], 0.0, x=0.0), rod={"points": COIL, "initial_twist": 2.0})
    scene["loads"] = []
    simulation = der.Simulation(scene)
    drawn, directors = simulation.theta.copy(), simulation.directors
    simulation.equilibrium()
    assert simulation.theta == pytest.approx(drawn, abs=1e-9)
    assert simulation.directors == pytest.approx(directors, abs=1e-9)


def test_a_nudge_in_a_run_over_time_turns_no_section():
    """The frames of a rod in motion have moved with it, and angles count from them."""
    scene = {**held(OBLIQUE, stiff={"rotary_inertia": 1e-3}), "start_from": "equilibrium"}
    del scene["analysis"]
    scene["time"] = {"duration": 1.0, "step": 1e-3}
    scene["loads"].append({"point_force": {"rod": "rod", "at": 0.7, "force": [0, -9, 9]}})
    runs = [der.Simulation(scene) for _ in range(2)]
    runs[0].extra_force[20] = runs[1].extra_force[20] = [0, 20, -30]
    for simulation in runs:
        simulation.step(150)
    assert np.abs(runs[0].theta).max() > 0.1
    runs[1].positions[20] += [0, 1e-9, 1e-9]
    runs[1].theta[7] += 1e-9
    for simulation in runs:
        simulation.step()
    assert runs[1].theta == pytest.approx(runs[0].theta, abs=1e-7)
    assert runs[1].directors == pytest.approx(runs[0].directors, abs=1e-7)


@pytest.mark.parametrize(("before", "after"), [(0.0, 6.5), (6.5, 0.0), (3.0, 12.0), (8.0, 8.0)])
def test_a_search_from_a_saved_equilibrium_follows_its_clamps(tmp_path, before, after):
    """From where that run had turned them, whole turns included, also about the opposite axis."""
    first = held(turned(AXES["oblique"], before, before))
    der.run(first, out=tmp_path / "first")
    opposite = [-component for component in AXES["oblique"]]
    scene = {**held(turned(opposite, -after, after)), "start_from": str(tmp_path / "first")}
    expected = der.Simulation(first)
    expected.equilibrium()
    for value in np.linspace(before, after, 40)[1:]:
        expected.prescribe(1, angle=value, twist=value)
        expected.equilibrium()
    simulation = der.Simulation(scene)
    simulation.equilibrium()
    check_the_same(simulation, expected)


def random_scene(seed) -> Scene:
    """Clamps that move and turn by up to two turns, one of them maybe free to spin; drawn bends,
    natural curvature, unequal stiffnesses, a force in the middle."""
    random = np.random.default_rng(seed)

    def motion(x, y, spins):
        prescribed = {"x": float(random.uniform(*x)), "y": float(random.uniform(-y, y))}
        prescribed["z"] = float(random.uniform(-y, y))
        if random.random() < 0.8:
            axis = random.normal(size=3).tolist()
            angle = random.choice([1, 4, 9, 14]) * random.uniform(-1, 1)
            prescribed["rotation"] = {"axis": axis, "angle": float(angle)}
        if not spins and random.random() < 0.6:
            prescribed["twist"] = float(random.uniform(-9, 9))
        return {"clamp": "tangent" if spins else True, "prescribe": prescribed}

    s = np.linspace(0, 1, int(random.integers(31, 81)))
    bends = random.uniform(-0.25, 0.25, (3, 2)) * random.integers(0, 2)
    drawn = sum(np.outer(np.sin((k + 1) * np.pi * s), bends[k]) for k in range(3))
    rod = {"points": np.column_stack([s, drawn]).tolist()}
    if random.random() < 0.5:
        rod["natural_curvature"] = random.uniform(-4, 4, 2).tolist()
    if random.random() < 0.3:
        rod["initial_twist"] = float(random.uniform(-6, 6))
    stiff = {"EI2": random.uniform(0.4, 2.5), "GJ": random.uniform(0.4, 1.5)}
    ends = [motion((0.0, 0.1), 0.3, False), motion((-0.6, 0.2), 0.3, random.random() < 0.4)]
    scene = held({}, ends[0], (), stiff, rod, random.uniform(-20, 20, 3) * random.integers(0, 2))
    scene["supports"][1] = {**END, **ends[1]}
    return scene


@pytest.mark.filterwarnings("ignore:.*too coarse for the twist")
@pytest.mark.parametrize("hundred", range(4))
def test_random_equilibria_that_a_program_writes_are_kept(hundred):
    """Where sections can rest in several ways, those are found that leave the nodes at rest."""
    kept = 0
    for seed in range(100 * hundred, 100 * hundred + 40):
        scene = random_scene(seed)
        read = der.Simulation(scene)
        try:
            report = read.equilibrium()
        except der.NotConvergedError:
            continue
        if report.stability != "stable" or report.largest_turning_angle > 0.9:
            continue
        written = der.Simulation(scene)
        written.positions[...] = read.positions
        written.equilibrium()
        assert written.positions == pytest.approx(read.positions, abs=1e-6), seed
        assert written.probes["energy"] == pytest.approx(read.probes["energy"], rel=1e-6), seed
        kept += 1
    assert kept > 25


def test_turns_that_positions_do_not_tell_are_said():
    """A clamp that has turned across the tangent by a turn twists a straight rod by one turn, this
    way or that."""
    scene = held(turned([0, 0, 1], 2 * np.pi, x=0.01), force=(0, 0, 0))
    simulation = der.Simulation(scene)
    simulation.positions[:, 0] *= 1.01
    with pytest.warns(der.DerWarning, match="'rod' is twisted: .* Write theta as well"):
        simulation.equilibrium()
