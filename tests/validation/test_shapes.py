"""Rods drawn by segments, against `references/bent_wire.py`; corners and jumps are known."""

import der
import numpy as np
import pytest
from references.bent_wire import Leg, Wire
from spatial_scenes import CLAMPED, QUANTITIES, section

STIFFNESS = (2.0, 1.0, 0.7, 1e3)  # EI1, EI2, GJ, EA
SMOOTH = ((0.0, 0.0, 1.0), 0.0)
#: Direction of the tangent behind the first arc, to the right of x [rad].
RIGHT = 0.6 - np.radians(4)
#: Corners of 4 degrees, which no polyline could have, and of 70 out of the plane; between them an
#: arc, one of another radius in another plane, and a line.
LEGS = (
    Leg(0.5, SMOOTH),
    Leg(0.5, ((0.0, 0.0, 1.0), np.radians(4)), bent=(0.0, 0.0, -1.2)),
    Leg(0.3, SMOOTH, bent=(2.0 * np.sin(RIGHT), 2.0 * np.cos(RIGHT), 1.5)),
    Leg(0.4, SMOOTH),
)
PLANAR = (
    Leg(0.5, SMOOTH),
    Leg(0.5, ((0.0, 0.0, 1.0), np.radians(4)), bent=(0.0, 0.0, -1.2)),
    Leg(0.3, SMOOTH, bent=(0.0, 0.0, 2.5)),
    Leg(0.4, ((0.0, 0.0, 1.0), np.radians(-70))),
)
#: Both sides of all borders and nodes inside, then places between nodes: leg and share of it.
PLACES = [(0, 0.0), (0, 1.0), (1, 0.0), (1, 0.4), (1, 1.0), (2, 0.0), (2, 0.5), (2, 1.0), (3, 0.0)]
BETWEEN = [(1, 0.37), (2, 0.63)]


def along_x(director):
    tangent = np.array([1.0, 0.0, 0.0])
    return np.column_stack([director, np.cross(tangent, director), tangent])


def shape_of(wire, dimension):
    """Lines, and arcs through their middles."""
    points = wire.points(2)[1:, :dimension].tolist()
    return [
        {"arc": {"to": end, "through": middle}} if any(leg.bent) else {"line": end}
        for leg, middle, end in zip(wire.legs, points[::2], points[1::2], strict=True)
    ]


def found(wire, nodes, quantities, dimension, places):
    starts = np.cumsum([0.0, *(leg.length for leg in wire.legs)])
    probes = {}
    for i, (leg, share) in enumerate(places):
        at = float(starts[leg] + share * wire.legs[leg].length)
        for quantity in quantities:
            probes[f"{quantity}-{i}"] = {"rod": "rod", "quantity": quantity, "at": at}
            if quantity not in ("x", "y", "z"):
                probes[f"{quantity}-{i}"]["side"] = "before" if share == 1.0 else "after"
    EI1, EI2, GJ, EA = wire.stiffness
    if dimension == 2:
        across = section(EA=EA, EI=EI1)
    else:
        across = section(wire.frame[:, 0], EA=EA, EI1=EI1, EI2=EI2, GJ=GJ)
    rod = {"name": "rod", "nodes": nodes, "from": [0.0] * dimension, "cross_section": across}
    force = {"rod": "rod", "at": "end", "force": list(wire.tip[:dimension])}
    scene = {
        "rods": [{**rod, "shape": shape_of(wire, dimension)}],
        "supports": CLAMPED,
        "loads": [{"point_force": force}],
        "analysis": "static",
        "output": {"probes": probes},
    }
    result = der.run(scene)
    values = [[result.probes[f"{q}-{i}"][-1] for q in quantities] for i in range(len(places))]
    return np.array(values)


def check(fitted_order, wire, quantities, dimension):
    columns = [QUANTITIES.index(quantity) for quantity in quantities]
    names = [q.removesuffix("_1") for q in quantities] if dimension == 2 else quantities
    exact, between = (wire.solve(places)[:, columns] for places in (PLACES, BETWEEN))
    scale = np.abs(exact).max(axis=0)
    sizes = [34, 68, 136]
    errors = np.array([found(wire, n + 1, names, dimension, PLACES) - exact for n in sizes])
    assert (np.abs(errors[-1]) < 5e-4 * scale).all()
    for n in sizes:  # errors depend on where in its edge a place lies
        near = found(wire, n + 1, names, dimension, BETWEEN) - between
        assert (np.abs(near) < 6.0 / n**2 * scale).all()
    for i, place in enumerate(PLACES):
        for k, quantity in enumerate(quantities):
            if np.abs(errors[:, i, k]).max() < 2e-5 * scale[k]:
                continue  # terms of order 3 are as large
            order = fitted_order([1 / n for n in sizes], errors[:, i, k])
            assert order > 1.85, (place, quantity, order)


def test_segments_in_space(fitted_order):
    wire = Wire(LEGS, along_x([0.0, 0.6, 0.8]), STIFFNESS, tip=(1.0, 0.7, -1.4))
    check(fitted_order, wire, list(QUANTITIES), 3)


def test_segments_in_the_plane(fitted_order):
    wire = Wire(PLANAR, along_x([0.0, 1.0, 0.0]), (1.0, 1.0, 1.0, 1e3), tip=(0.6, -0.9, 0.0))
    check(fitted_order, wire, ["x", "y", "curvature_1", "moment_1", "tension"], 2)


@pytest.mark.parametrize("nodes", [5, 9])
def test_a_tight_arc_of_few_elements_has_no_corner(nodes):
    """As a polyline its turns of 45 degrees and more would be corners; the moment is known."""
    rod = {"name": "rod", "from": [0, 0], "nodes": nodes, "cross_section": section(EA=1e9, EI=1e4)}
    bend = {"arc": {"to": [1.1, 0.1], "radius": 0.1}}
    scene = {
        "rods": [{**rod, "shape": [{"line": [1, 0]}, bend, {"line": [1.1, 1]}]}],
        "supports": CLAMPED,
        "loads": [{"point_force": {"rod": "rod", "at": "end", "force": [1, 0]}}],
        "analysis": "static",
        "output": {
            "probes": {"k": {"rod": "rod", "quantity": "curvature", "at": 1, "side": "before"}}
        },
    }
    curvature = der.run(scene).probes["k"][-1]
    assert curvature == pytest.approx(-1e-4, rel=1e-3)  # of the line, with EI as large as it is


@pytest.mark.parametrize("kind", ["helix", "spline"])
def test_order_of_other_curves(kind):
    """Against meshes of themselves."""
    shapes = {
        "helix": {"axis": [0, 0, 1], "centre": [0, 0, 0], "pitch": 0.4, "turns": 1.3},
        "spline": [[0.7, 0.9, 0.1], [0.0, 1.2, 0.4], [-0.8, 0.9, 0.5]],
    }
    rod = {"name": "rod", "from": [1, 0, 0], "shape": [{kind: shapes[kind]}]}
    rod["cross_section"] = section([0, 0, 1], EA=1e4, EI1=2.0, EI2=1.0, GJ=0.8)
    at = {"rod": "rod", "at": "middle"}
    probes = {q: {**at, "quantity": q} for q in QUANTITIES}
    values = []
    for cells in (40, 80, 160, 320):
        scene = {
            "rods": [{**rod, "nodes": cells + 1}],
            "supports": CLAMPED,
            "loads": [{"point_force": {"rod": "rod", "at": "end", "force": [0.1, 0.2, -0.3]}}],
            "analysis": "static",
            "output": {"probes": probes},
        }
        result = der.run(scene)
        values.append([result.probes[quantity][-1] for quantity in QUANTITIES])
    changes = np.abs(np.diff(values, axis=0))
    assert (changes[1:] < 0.27 * changes[:-1] + 2e-6 * np.abs(values[-1])).all()


def test_joined_segments_are_one_rod():
    """Cut by a rigid joint at a place within an arc, which the legs then end at."""
    arc = {"arc": {"to": [1, 1], "radius": 1}}
    half = {"to": [2**-0.5, 1 - 2**-0.5], "radius": 1}
    rod = {"cross_section": section(EA=1e4, EI=1.0)}
    arm = {"name": "arm", "nodes": 5, "from": half["to"], "to": [1, 0], **rod}
    one = {**rod, "name": "bow", "nodes": 21, "from": [0, 0], "shape": [arc, {"line": [1, 1.5]}]}
    probes = {
        "x": {"rod": "bow", "quantity": "x", "at": "end"},
        "moment": {"rod": "bow", "quantity": "moment", "at": "start"},
    }
    scene = {
        "rods": [one, arm],
        "joints": [
            {"name": "fork", "of": [{"rod": "bow", "at": np.pi / 4}, {"rod": "arm", "at": "start"}]}
        ],
        "supports": [{"rod": "bow", "at": "start", "clamp": True}],
        "loads": [
            {"point_force": {"rod": "bow", "at": "end", "force": [0.1, -0.2]}},
            {"point_force": {"rod": "arm", "at": "end", "force": [0.3, 0.1]}},
        ],
        "analysis": "static",
        "output": {"probes": probes},
    }
    found = [
        der.run(der.Scenario.from_dict(scene))
        for scene in (scene, _refined(scene, 2), _refined(scene, 4))
    ]
    for name in probes:
        coarse, middle, fine = (result.probes[name][-1] for result in found)
        assert abs(fine - middle) < 0.3 * abs(middle - coarse) + 1e-9
        assert abs(fine - middle) < 1e-3


def _refined(scene, parts):
    return {**scene, "rods": [{**rod, "subdivide": parts} for rod in scene["rods"]]}
