"""Moments, torque and tension of rods in space beside point forces, at clamps and at free ends,
against the boundary value problem of `references/kirchhoff_rod.py`."""

import functools

import der
import numpy as np
import pytest
from references.kirchhoff_rod import UPRIGHT, Held, Loaded, Rod, constant, directors, follow
from scenes import END, START, tip_force
from spatial_scenes import measured, rod_through, section, straight_rod

STRONG, WEAK, TWISTING, STRETCHING = 2.0, 1.0, 0.7, 1e3
NATURAL = (0.8, -0.6, 1.5)
TIP, INSIDE = (1.2, -0.5, 0.7), (-2.0, 1.5, -2.5)
QUANTITIES = (
    *("curvature_1", "curvature_2", "twist"),
    *("moment_1", "moment_2", "torque", "tension"),
)
#: Places and sides; the force stands at 0.4.
PLACES = {
    "start": (0.0, "after"),
    "before": (0.4, "before"),
    "after": (0.4, "after"),
    "near": (0.45, "after"),
    "end": (1.0, "before"),
}


@pytest.fixture(scope="module")
def exact():
    """Values at the places, shape (places, quantities)."""
    rod = Rod(1.0, (WEAK, STRONG), TWISTING, STRETCHING, constant(*NATURAL))
    start = Held((0, 0, 0), UPRIGHT)
    found = follow(
        rod,
        start,
        lambda share: Loaded(share * np.array(TIP)),
        steps=4,
        segments=5,  # the second border is at 0.4
        degree=16,
        inside=[(1, INSIDE)],
    )
    assert found.boundary.shooting_gap(found.solution) < 1e-10
    places = np.array([s - 1e-12 if side == "before" else s for s, side in PLACES.values()])
    u1, u2, u3, strain = found.strains(places)
    n1, n2, n3 = NATURAL
    moments = [STRONG * (u2 - n2), -WEAK * (u1 - n1), TWISTING * (u3 - n3)]
    return np.vstack([u2, -u1, u3, *moments, STRETCHING * strain]).T


def found(edges):
    beam = section([0, 1, 0], EA=STRETCHING, EI1=STRONG, EI2=WEAK, GJ=TWISTING)
    shape = {"natural_curvature": [NATURAL[1], -NATURAL[0]], "natural_twist": NATURAL[2]}
    loads = [
        {"point_force": {"rod": "rod", "at": 0.4, "force": list(INSIDE)}},
        *tip_force(*TIP),
    ]
    scene = straight_rod(edges, beam, rod=shape, loads=loads)
    probes = {
        f"{quantity}-{name}": {"rod": "rod", "at": s, "quantity": quantity}
        | ({"side": side} if quantity == "tension" else {})
        for quantity in QUANTITIES
        for name, (s, side) in PLACES.items()
    }
    result = der.run(der.Scenario.from_dict({**scene, "output": {"probes": probes}}))
    return np.array(
        [[result.probes[f"{quantity}-{name}"][-1] for quantity in QUANTITIES] for name in PLACES]
    )


@pytest.mark.parametrize("sizes", [(42, 82, 162), (20, 40, 80)], ids=["between nodes", "at a node"])
def test_order_2_everywhere(exact, fitted_order, sizes):
    """The force stands at 4/5 of an edge, or at a node."""
    errors = np.array([found(edges) - exact for edges in sizes])
    scale = np.abs(exact).max(axis=0)
    assert (np.abs(errors[-1]) < 5e-3 * scale).all()
    for i, name in enumerate(PLACES):
        for k, quantity in enumerate(QUANTITIES):
            if np.abs(errors[:, i, k]).max() < 1e-9 * scale[k]:
                continue  # moments at a free end are known
            order = fitted_order([1 / n for n in sizes], errors[:, i, k])
            assert order > 1.9, (name, quantity, errors[:, i, k])


def test_a_section_that_may_turn_in_its_clamp_bears_no_torque():
    """However it has turned there."""
    beam = section([0, 1, 0], EA=STRETCHING, EI1=STRONG, EI2=WEAK, GJ=TWISTING)
    supports = [{**START, "clamp": "tangent"}, {**END, "clamp": True, "prescribe": {"twist": 2.0}}]
    values, _ = measured(
        straight_rod(8, beam, supports=supports), ["start", 0.3, "end"], ["torque"]
    )
    assert values == pytest.approx(np.zeros((3, 1)), abs=1e-9)


def test_without_sections(fitted_order):
    """A round rod that cannot twist has the same moment and tension as one whose sections count."""
    places = {"before": (0.4, "before"), "after": (0.4, "after"), "start": (0.0, "after")}
    loads = [
        {"point_force": {"rod": "rod", "at": 0.4, "force": list(INSIDE)}},
        *tip_force(*TIP),
    ]
    probes = {
        f"{quantity}-{name}": {"rod": "rod", "at": s, "side": side, "quantity": quantity}
        for quantity in ("moment", "curvature", "tension")
        for name, (s, side) in places.items()
    }
    beam = section(EA=STRETCHING, EI=1.0, GJ=TWISTING)
    scene = rod_through(
        np.linspace([0, 0, 0], [1, 0, 0], 23), beam, loads=loads, output={"probes": probes}
    )
    scene["rods"][0]["natural_curvature"] = 0
    scene["supports"] = [{**START, "clamp": "tangent"}]
    with_sections, without = (
        der.run(der.Scenario.from_dict({**scene, "model": model})).summary["probes"]
        for model in ("spatial", "spatial_bend")
    )
    for name in probes:
        assert without[name]["final"] == pytest.approx(with_sections[name]["final"], rel=1e-3)


BOW = 2.0  # turn of the drawn arc [rad], whose length is 1
TURNED = 1.5  # of the sections as they are drawn [rad/m]
ENDS = ((0.0, "after"), (1e-3, "after"), (1.0, "before"))


def bow(edges, **more):
    """A clamped circular arc in the x-y plane, without stress as it is drawn."""
    turn = BOW * np.arange(edges + 1) / edges
    points = np.column_stack([np.sin(turn), 1 - np.cos(turn), 0 * turn]) / BOW
    beam = section([0, 1, 0], EA=STRETCHING, EI1=STRONG, EI2=WEAK, GJ=TWISTING)
    return rod_through(points, beam, rod={"initial_twist": TURNED}, **more)


def natural_of_the_bow(s):
    """Curvatures towards the directors, which start towards the centre, and twist."""
    return np.stack([BOW * np.cos(TURNED * s), -BOW * np.sin(TURNED * s), TURNED + 0 * s])


def probed(scene, places, quantities=QUANTITIES):
    probes = {
        f"{quantity}-{i}": {"rod": "rod", "at": s, "side": side, "quantity": quantity}
        for quantity in quantities
        for i, (s, side) in enumerate(places)
    }
    result = der.run(der.Scenario.from_dict({**scene, "output": {"probes": probes}}))
    return np.array(
        [[result.probes[f"{q}-{i}"][-1] for q in quantities] for i in range(len(places))]
    )


@pytest.mark.parametrize("clamps", [("start",), ("end",), ("start", "middle", "end")], ids=str)
def test_drawn_curvature_at_clamps(fitted_order, clamps):
    """No load: the curvatures are those that are drawn."""
    places = [*ENDS, (0.5, "before"), (0.5, "after")]
    exact = natural_of_the_bow(np.array([s for s, _ in places])).T
    sizes = (40, 80, 160)
    errors = []
    for edges in sizes:
        held = [{"rod": "rod", "at": at, "clamp": True} for at in clamps]
        length = edges * 2 * np.sin(BOW / 2 / edges) / BOW
        at = [(s * length, side) for s, side in places]
        found = probed(bow(edges, supports=held), at, ("curvature_1", "curvature_2", "twist"))
        errors.append(np.abs(found - exact))
    errors = np.array(errors)
    assert errors[-1].max() < 2e-3
    for of_place in errors.reshape(len(sizes), -1).T:
        if of_place.max() > 1e-9:
            assert fitted_order([1 / n for n in sizes], of_place) > 1.9


@functools.cache
def loaded_bow():
    """The boundary value problem of the bow under a force at its tip."""

    def natural(s):
        k1, k2, twist = natural_of_the_bow(s)
        return np.stack([-k2, k1, twist])  # turning about directors 1 and 2

    there = follow(
        Rod(1.0, (WEAK, STRONG), TWISTING, STRETCHING, natural),
        Held((0, 0, 0), UPRIGHT),
        lambda share: Loaded(share * np.array(TIP)),
        steps=4,
        segments=4,
        degree=18,
    )
    assert there.shooting_error() < 1e-9
    return there


def test_a_loaded_bow_at_its_clamp(fitted_order):
    """All that is probed at the clamp of a rod that is drawn curved and turned.

    The order of the curvatures is in the test before.
    """
    there = loaded_bow()
    places = [(0.0, "after"), (0.3, "after")]
    s = np.array([place for place, _ in places])
    u1, u2, u3, strain = there.strains(s)
    n1, n2, n3 = there.rod.natural(s)
    moments = [STRONG * (u2 - n2), -WEAK * (u1 - n1), TWISTING * (u3 - n3)]
    exact = np.vstack([u2, -u1, u3, *moments, STRETCHING * strain]).T
    sizes = (80, 160, 320)
    errors = []
    for edges in sizes:
        length = edges * 2 * np.sin(BOW / 2 / edges) / BOW
        at = [(place * length, side) for place, side in places]
        errors.append(np.abs(probed(bow(edges, loads=tip_force(*TIP)), at) - exact))
    errors = np.array(errors) / np.abs(exact).max(axis=0)
    assert errors[-1].max() < 1e-4
    for of_place in errors[:, :, 2:].reshape(len(sizes), -1).T:
        assert fitted_order([1 / n for n in sizes], of_place) > 1.9


def test_tangents_of_a_loaded_bow_beside_its_clamp(fitted_order):
    """At shares of the edge there, bent about both axes and twisted."""
    there = loaded_bow()
    sizes = (20, 40, 80)
    errors = []
    for edges in sizes:
        s = np.array([0.5, 1, 1.25, 1.5, 2]) / edges
        exact = directors(there.at(s)[3:7])[:, 2].T
        length = edges * 2 * np.sin(BOW / 2 / edges) / BOW
        at = [(place * length, "after") for place in s]
        found = probed(bow(edges, loads=tip_force(*TIP)), at, ("tx", "ty", "tz"))
        errors.append(np.abs(found - exact).max())
    assert errors[-1] < 1e-3
    assert fitted_order([1 / n for n in sizes], errors) > 1.9


def plane_bow(edges, curved, model, stretching):
    """The bow without its twist, drawn as an arc, or straight with its curvature given or actuated,
    under a force in its plane."""
    dimension = 2 if model == "planar" else 3
    points = np.array(bow(edges)["rods"][0]["points"])
    if curved != "drawn":
        points = np.linspace(np.zeros(3), [1, 0, 0], edges + 1)
    stiff = {"EI": STRONG} if model == "planar" else {"EI1": STRONG, "EI2": WEAK, "GJ": TWISTING}
    director = None if model == "planar" else [0, 1, 0]
    curvature = BOW if model == "planar" else [BOW, 0]
    more = {}
    if curved == "given":
        more["rod"] = {"natural_curvature": curvature}
    elif curved == "actuated":
        more["actuation"] = [{"name": "bow", "rod": "rod", "natural_curvature": curvature}]
    loads = tip_force(*IN_PLANE[:dimension])
    beam = section(director, EA=stretching, **stiff)
    return rod_through(points[:, :dimension], beam, loads=loads, **more) | {"model": model}


IN_PLANE = (1.2, -0.5, 0.0)


@functools.cache
def at_the_clamp_of_the_plane_bow(stretching):
    """Curvature, moment and tension."""
    there = follow(
        Rod(1.0, (WEAK, STRONG), TWISTING, stretching, constant(0.0, BOW, 0.0)),
        Held((0, 0, 0), UPRIGHT),
        lambda share: Loaded(share * np.array(IN_PLANE)),
        steps=2,
        degree=12,
    )
    assert there.shooting_error() < 1e-9
    _, bend, _, strain = there.strains(np.array([0.0]))
    return np.array([bend[0], STRONG * (bend[0] - BOW), stretching * strain[0]])


def errors_at_the_clamp(curved, model, stretching, sizes):
    """Shape (sizes, 3)."""
    towards = "" if model == "planar" else "_1"
    names = (f"curvature{towards}", f"moment{towards}", "tension")
    scenes = [plane_bow(edges, curved, model, stretching) for edges in sizes]
    found = np.array([probed(scene, [(0.0, "after")], names)[0] for scene in scenes])
    return found - at_the_clamp_of_the_plane_bow(stretching)


@pytest.mark.parametrize("model", ["planar", "spatial"])
@pytest.mark.parametrize("curved", ["drawn", "given", "actuated"])
def test_a_loaded_bow_in_the_plane(fitted_order, curved, model):
    """Tension at the clamp, where the edge of the chain leans by more than in a straight rod."""
    sizes = (40, 80, 160)
    errors = errors_at_the_clamp(curved, model, 1e5, sizes)
    assert np.abs(errors[-1]).max() < 2e-4
    for of_quantity in errors.T:
        if np.abs(of_quantity).max() > 1e-7:  # a curvature that is given is met without a load
            assert fitted_order([1 / n for n in sizes], of_quantity) > 1.9


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_tension_at_the_clamp_of_a_bow_that_stretches(model):
    """By 1.2 %: a part of order 1, a tenth of strain times curvature times edge length of the
    tension, which is 1.2 (docs/results.md)."""
    sizes = np.array([40, 80, 160, 320])
    tension, stiff = (
        errors_at_the_clamp("drawn", model, stretching, sizes)[:, 2] for stretching in (100, 1e5)
    )
    assert (np.abs(tension - stiff) < 0.1 * 0.012 * BOW / sizes * 1.2).all()


def clothoid(s):
    """Points of the curve in the x-y plane with the curvature 1 + 2 s, shape (n, 3)."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    along = 0.5 * s[:, None] * (1 + nodes)
    angle = along + along**2
    x, y = (0.5 * s * (part(angle) @ weights) for part in (np.cos, np.sin))
    return np.column_stack([x, y, 0 * s])


MESHES = {
    "longer edges from the middle on": lambda n: np.repeat([1.0, 1.5], n),
    "longer edges before the middle": lambda n: np.repeat([1.5, 1.0], n),
    "every other edge longer": lambda n: np.tile([1.5, 1.0], n),
}


@pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES)
def test_drawn_curvature_of_a_twisted_rod_with_uneven_edges(fitted_order, mesh):
    """At a node between edges of other lengths the mean of their sections is that of a place beside
    the node, and so is the turn from one to the next."""
    twist, sizes = 2.0, (10, 20, 40, 80)
    errors = []
    for n in sizes:
        edges = mesh(n)
        s = np.concatenate([[0.0], np.cumsum(edges)]) / edges.sum()
        # The width starts along z, towards which the drawn rod does not bend.
        strip = section([0, 0, 1], EA=STRETCHING, EI1=STRONG, EI2=WEAK, GJ=TWISTING)
        scene = rod_through(clothoid(s), strip, rod={"initial_twist": twist})
        turned, curvature = twist * s[n], 1.0 + 2.0 * s[n]
        exact = -curvature * np.array([np.sin(turned), np.cos(turned)])
        values, _ = measured(scene, [{"node": n}], ("curvature_1", "curvature_2"))
        errors.append(values[0] - exact)
    assert np.abs(errors[-1]).max() < 2e-3
    for error in np.transpose(errors):
        assert fitted_order([1 / n for n in sizes], error) > 1.9


@pytest.mark.parametrize("holds", [{"spring": {"rotational_stiffness": 2.0}}, {"clamp": True}])
@pytest.mark.parametrize("longer", [1, 2], ids=["equal edges", "longer edges beyond"])
def test_where_the_natural_twist_jumps(holds, longer):
    """Between two clamps the twist without stress is 0 before the middle and c beyond it. With the
    rotation f of the section there, 2 GJ f is the torque before it, GJ (-2 f - c) that beyond, and
    the spring takes up k f: f = -GJ c/(4 GJ + k). Exact on any mesh: all is linear."""
    n, c, GJ = 8, 4.0, 0.8
    k = holds["spring"]["rotational_stiffness"] if "spring" in holds else np.inf
    turned = -GJ * c / (4.0 * GJ + k)
    x = np.concatenate([np.linspace(0, 0.5, n + 1), np.linspace(0.5, 1, n // longer + 1)[1:]])
    middle = {"rod": "rod", "at": {"node": n}}
    supports = [*({"rod": "rod", "at": at, "clamp": True} for at in ("start", "end"))]
    scene = rod_through(
        np.column_stack([x, 0 * x, 0 * x]),
        section(EI=1.0, GJ=GJ),
        [*supports, {**middle, **holds}],
        rod={"natural_twist": [*[0.0] * n, c * longer / (1 + longer), *[c] * (n // longer)]},
    )
    probes = {
        f"{quantity}-{side}": {**middle, "quantity": quantity, "side": side}
        for quantity in ("twist", "torque", "natural_twist")
        for side in ("before", "after")
    }
    probes["reaction"] = {"quantity": "reaction_moment_x", "support": 2}
    found = der.run({**scene, "output": {"probes": probes}}).probes
    torques = 2.0 * GJ * turned, GJ * (-2.0 * turned - c)
    exact = {
        **{"twist-before": 2.0 * turned, "twist-after": -2.0 * turned},
        **{"torque-before": torques[0], "torque-after": torques[1]},
        **{"natural_twist-before": 0.0, "natural_twist-after": c},
        "reaction": torques[0] - torques[1],
    }
    assert {name: values[-1] for name, values in found.items()} == pytest.approx(exact, abs=1e-9)


def test_natural_twist_beside_a_jump_of_a_list_on_alternating_edges():
    """Linear on both sides of the node: its two values there are exact, as the list has them at
    its nodes and not beside them."""
    edges = np.tile([1.3, 0.7], 10) / 20
    s = np.concatenate([[0.0], np.cumsum(edges)])
    node = 10
    before, after = 2.0 * s, 5.0 - 2.0 * s
    twist = np.where(np.arange(21) < node, before, after)
    shares = edges[[node - 1, node]] / edges[[node - 1, node]].sum()
    twist[node] = shares @ [before[node], after[node]]
    scene = rod_through(
        np.column_stack([s, 0 * s, 0 * s]),
        section(EI=1.0, GJ=0.8),
        rod={"natural_curvature": [0, 0], "natural_twist": twist.tolist()},
    )
    here = {"rod": "rod", "at": {"node": node}, "quantity": "twist"}
    probes = {side: {**here, "side": side} for side in ("before", "after")}
    found = der.run({**scene, "output": {"probes": probes}}).probes
    values = [found[side][-1] for side in ("before", "after")]
    assert values == pytest.approx([before[node], after[node]], abs=1e-9)


@pytest.mark.parametrize("model", ["spatial_bend", "spatial"])
def test_magnitudes_where_the_vector_passes_by_zero(model):
    """Between the nodes beside a zero the moment is a line, and its magnitude is none: with a line
    between the magnitudes it was twice the moment at any mesh, and its minimum was not 0.
    Exact: M = 12 EI u (1/2 - s) / L^3 of a beam whose end is shifted by u, to second order in u.
    """
    shift = 1e-3
    rod = straight_rod(
        9,
        section([0, 1, 0], EA=1e4, EI=1.0, GJ=0.7),
        supports=[
            {"rod": "rod", "at": "start", "clamp": True if model == "spatial" else "tangent"},
            {"rod": "rod", "at": "end", "clamp": "tangent", "prescribe": {"y": shift}},
        ],
    )
    rod["model"] = model
    probes = {
        f"{quantity}_{i}": {"rod": "rod", "at": at, "quantity": quantity}
        for quantity in ("moment", "curvature")
        for i, at in enumerate((0.47, 0.52))
    }
    for reduce in ("min", "max"):
        probes[reduce] = {"rod": "rod", "over": "rod", "reduce": reduce, "quantity": "moment"}
    found = der.run({**rod, "output": {"probes": probes}}).probes
    for i, at in enumerate((0.47, 0.52)):
        exact = 12 * shift * abs(0.5 - at)
        assert found[f"moment_{i}"][-1] == pytest.approx(exact, rel=1e-2)
        assert found[f"curvature_{i}"][-1] == pytest.approx(exact, rel=1e-2)
    assert found["min"][-1] == pytest.approx(0.0, abs=1e-12)
    assert found["max"][-1] == pytest.approx(6 * shift, rel=1e-2)


def test_the_least_speed_of_a_rod_that_turns_about_a_place_between_nodes():
    scene = straight_rod(9, section([0, 1, 0], EA=1e4, EI=1.0, GJ=0.7), supports=[])
    s = np.linspace(0, 1, 10)
    scene["rods"][0]["initial_velocity"] = np.column_stack([0 * s, 0 * s, s - 0.5]).tolist()
    scene |= {"time": {"duration": 1, "step": 0.1}}
    scene.pop("analysis", None)
    low = {"rod": "rod", "over": "rod", "reduce": "min", "quantity": "speed"}
    simulation = der.Simulation({**scene, "output": {"probes": {"low": low}}})
    assert simulation.probes["low"] == pytest.approx(0.0, abs=1e-15)
