"""Static scenes: every support, load, natural shape and probe, against the elastica."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from .case import Case, Label, Truth, UnsolvedError
from .rod import Array, Mesh, NoSolutionError
from .shapes import Drawing, Random, draw

ENERGIES = (
    "stretch_energy",
    "bend_energy",
    "spring_energy",
    "elastic_energy",
    "gravity_energy",
    "total_energy",
)
FIELDS = ("x", "y", "curvature", "moment", "strain", "tension")


def static(rng: Random) -> Case:
    drawing = draw(rng)
    scene: dict[str, Any] = {
        "title": "Audit: statics",
        "rods": [drawing.entry],
        "supports": [],
        "loads": [],
        "analysis": "static",
    }
    hold(rng, drawing, scene)
    load(rng, drawing, scene)
    if not scene["loads"]:
        del scene["loads"]
    if rng.random() < 0.15:
        drawing.entry["curvature"] = "tangent"
    probes = ask(rng, drawing)
    scene["output"] = {"probes": probes}

    def truths(final: dict[str, Any]) -> Mapping[Label, Truth]:
        return solve(drawing, final, probes)

    return Case("static", scene, truths)


# -- the grammar ----------------------------------------------------------------------------------


def _node(rng: Random, drawing: Drawing, low: int = 1) -> int:
    return int(rng.integers(low, drawing.nodes - low))


def hold(rng: Random, drawing: Drawing, scene: dict[str, Any]) -> None:
    """Supports: clamps, pins, rollers, springs of both kinds, held and moved."""
    rod, L = drawing.rod, drawing.length
    unit_force, unit_moment = rod.EI / L**2, rod.EI / L
    last = float(drawing.node_u[-1])
    supports = scene["supports"]

    def fixed(at: Any, u: float, components: str) -> None:
        supports.append({"rod": "rod", "at": at, "fix": list(components)})
        rod.place(u).fix = ("x" in components, "y" in components)

    def clamped(at: Any, u: float, moved: float) -> None:
        entry: dict[str, Any] = {"rod": "rod", "at": at, "clamp": True}
        place = rod.place(u)
        place.fix, place.clamp = (True, True), True
        if rng.random() < moved:
            place.turn = float(rng.uniform(-1.2, 1.2) * (6 if rng.random() < 0.15 else 1))
            shift = rng.uniform(-0.1, 0.1, 2) * L
            place.shift = (float(shift[0]), float(shift[1]))
            entry["prescribe"] = {"x": place.shift[0], "y": place.shift[1], "angle": place.turn}
        supports.append(entry)

    def springs(at: Any, u: float, *, point: bool, torsion: bool) -> None:
        spring: dict[str, Any] = {}
        place = rod.place(u)
        if point:
            k = unit_force / L * 10.0 ** rng.uniform(0, 4, 2)
            place.spring = (float(k[0]), float(k[1]))
            spring["stiffness"] = k.tolist()
            if rng.random() < 0.4:
                shift = rng.uniform(-0.1, 0.1, 2) * L
                place.anchor_shift = (float(shift[0]), float(shift[1]))
                drawn = rod.curve(np.array([u]))[0][0]
                spring["anchor"] = (drawn + shift).tolist()
        if torsion:
            place.torsion = float(unit_moment * 10.0 ** rng.uniform(-0.5, 3))
            spring["rotational_stiffness"] = place.torsion
        supports.append({"rod": "rod", "at": at, "spring": spring})

    def somewhere() -> tuple[float, float]:
        s = float(rng.uniform(1.2 / (drawing.nodes - 1), 0.95) * L)
        return s, drawing.u(s)

    kind = rng.choice(
        ["clamp", "clamp", "pinned", "both_clamped", "clamp_pin", "clamp_roller", "interior",
         "interior_clamp", "springs", "torsion", "clamp_springs"]
    )  # fmt: skip
    if kind in ("clamp", "both_clamped", "clamp_pin", "clamp_roller", "clamp_springs"):
        clamped("start", 0.0, 0.3)
    if kind == "both_clamped":
        clamped("end", last, 0.6)
    if kind in ("clamp_pin", "pinned"):
        fixed("end", last, str(rng.choice(["xy", "x", "y"])))
    if kind == "clamp_roller":
        fixed("end", last, str(rng.choice(["x", "y"])))
    if kind in ("pinned", "interior"):
        fixed("start", 0.0, "xy")
    if kind == "interior":
        node = _node(rng, drawing)
        fixed({"node": node}, float(drawing.node_u[node]), "xy")
    if kind == "interior_clamp":
        node = _node(rng, drawing, 2)
        clamped({"node": node}, float(drawing.node_u[node]), 0.3)
    if kind == "springs":
        springs("start", 0.0, point=True, torsion=bool(rng.random() < 0.5))
        springs("end", last, point=True, torsion=bool(rng.random() < 0.5))
    if kind == "torsion":
        fixed("start", 0.0, "xy")
        springs("start", 0.0, point=False, torsion=True)
    if kind == "clamp_springs" or (kind == "pinned" and rng.random() < 0.3):
        s, u = somewhere()
        if kind == "pinned" or rng.random() < 0.6:
            torsion = bool(rng.random() < 0.5)
            springs(s, u, point=not torsion or bool(rng.random() < 0.5), torsion=torsion)
        else:
            springs("end", last, point=True, torsion=True)


def load(rng: Random, drawing: Drawing, scene: dict[str, Any]) -> None:
    """Loads: forces and moments anywhere, distributed forces, foundations, gravity with spheres."""
    rod, L = drawing.rod, drawing.length
    unit = rod.EI / L**2
    last = float(drawing.node_u[-1])
    # Mostly large deflections; sometimes tiny ones, sometimes loads far beyond buckling.
    size = float(rng.choice([1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1e-4, 5.0]))
    for _ in range(int(rng.integers(1, 4))):
        kind = rng.choice(["force", "force", "moment", "moment", "line", "gravity", "foundation"])
        at: Any
        where = rng.random()
        if where < 0.35:
            at, u = "end", last
        elif where < 0.5:
            node = _node(rng, drawing)
            at, u = {"node": node}, float(drawing.node_u[node])
        else:
            at = float(rng.uniform(0.02, 0.98) * L)
            u = drawing.u(at)
            # A mesh cannot resolve two places within one element of the scene.
            element = last / (drawing.nodes - 1)
            if any(abs(u - other) < element for other in rod.places if 0 < other < last):
                continue
        if kind == "force":
            force = rng.uniform(-4, 4, 2) * unit * size
            place = rod.place(u)
            if any(place.fix):
                continue
            place.force = (place.force[0] + float(force[0]), place.force[1] + float(force[1]))
            entry = {"point_force": {"rod": "rod", "at": at, "force": force.tolist()}}
        elif kind == "moment":
            place = rod.place(u)
            if place.clamp:
                continue
            moment = float(rng.uniform(-3, 3) * unit * L * size)
            place.moment += moment
            entry = {"moment": {"rod": "rod", "at": at, "moment": moment}}
        elif kind == "line":
            force = rng.uniform(-5, 5, 2) * unit / L * size
            entry = {"distributed_force": {"rod": "rod", "force": force.tolist()}}
            lo, hi = _part(rng, drawing, entry["distributed_force"])
            rod.line_loads.append((lo, hi, (float(force[0]), float(force[1]))))
        elif kind == "foundation":
            k = unit / L**2 * 10.0 ** rng.uniform(0, 4, 2)
            k[rng.random(2) < 0.2] = 0.0
            if not k.any():
                continue
            entry = {"foundation": {"rod": "rod", "stiffness": k.tolist()}}
            lo, hi = _part(rng, drawing, entry["foundation"])
            rod.foundations.append((lo, hi, (float(k[0]), float(k[1]))))
        else:
            if any(rod.gravity):
                continue
            g = rng.uniform(-8, 8, 2) * unit / L / rod.mass_per_length * size
            rod.gravity = (float(g[0]), float(g[1]))
            entry = {"gravity": g.tolist()}
            if rng.random() < 0.4:
                _sphere(rng, drawing)
        scene["loads"].append(entry)


def _part(rng: Random, drawing: Drawing, entry: dict[str, Any]) -> tuple[float, float]:
    """Choose the whole rod or a part of it for a load, and write the part into its entry.

    A curve is taken whole: where it is refined, its parts move.
    """
    if not drawing.straight or rng.random() < 0.5:
        return 0.0, float(drawing.node_u[-1])
    lo, hi = np.sort(rng.uniform(0, drawing.length, 2))
    entry |= {"from": float(lo), "to": float(hi)}
    return float(lo), float(hi)


def _sphere(rng: Random, drawing: Drawing) -> None:
    """A heavy sphere on a node; it has no rotary inertia of its own."""
    rod, L = drawing.rod, drawing.length
    mass = rod.mass_per_length * L * float(rng.uniform(0.1, 1.0))
    radius = 0.02 * L
    density = mass / (4 / 3 * np.pi * radius**3)
    node = _node(rng, drawing)
    at: Any = {"node": node}
    if rng.random() < 0.5:
        node, at = drawing.nodes - 1, "end"
    drawing.entry["spheres"] = [{"at": at, "radius": radius, "density": density}]
    rod.place(float(drawing.node_u[node])).mass = mass


def ask(rng: Random, drawing: Drawing) -> dict[str, dict[str, Any]]:
    """Probes of every quantity: at nodes, at any arc length, at ends, extreme, energies."""
    probes: dict[str, dict[str, Any]] = {}
    for i in range(int(rng.integers(4, 9))):
        if rng.random() < 0.25:
            probes[f"p{i}"] = {"quantity": str(rng.choice(ENERGIES))}
            if rng.random() < 0.3:
                probes[f"p{i}"]["rod"] = "rod"
            continue
        probe: dict[str, Any] = {"quantity": str(rng.choice(FIELDS)), "rod": "rod"}
        where = rng.random()
        if where < 0.25:
            probe["at"] = str(rng.choice(["start", "end", "middle"]))
        elif where < 0.4:
            probe["at"] = {"node": int(rng.choice([1, 2, drawing.nodes - 2, drawing.nodes - 3]))}
        elif where < 0.55:
            probe["at"] = {"node": _node(rng, drawing)}
        elif where < 0.8:
            probe["at"] = float(rng.uniform(0, 1) * drawing.length)
        else:
            probe |= {"over": "rod", "reduce": str(rng.choice(["min", "max"]))}
        probes[f"p{i}"] = probe
    return probes


# -- the truth ------------------------------------------------------------------------------------


def solve(
    drawing: Drawing, final: dict[str, Any], probes: dict[str, dict[str, Any]]
) -> dict[Label, Truth]:
    """True values of the probes, on the branch that the run is on."""
    coarse, state, fine, fine_state = solution(drawing, final)
    found = {}
    for name, probe in probes.items():
        pair = value(drawing, coarse, state, probe), value(drawing, fine, fine_state, probe)
        if pair[0] is None or pair[1] is None:
            continue
        size = scale(fine, fine_state, probe["quantity"])
        found[name, "final"] = Truth(
            pair[1], 3 * abs(pair[1] - pair[0]) + 1e-10 * size, size, probe["quantity"]
        )
    return found


def solution(drawing: Drawing, final: dict[str, Any]) -> tuple[Mesh, Array, Mesh, Array]:
    """The equilibrium on the branch of the run, on two meshes."""
    degree = 20 if len(drawing.rod.knots) == 2 else 9
    coarse = Mesh(drawing.rod, degree)
    state = _branch(coarse, drawing, np.asarray(final["positions"]), final["tension"])
    fine = Mesh(drawing.rod, degree + 5, longest=0.2)
    try:
        return coarse, state, fine, fine.newton(_carry(coarse, state, fine))
    except NoSolutionError as error:
        raise UnsolvedError("the reference is not converged") from error


def _branch(mesh: Mesh, drawing: Drawing, nodes: Array, tension: tuple[Array, Array]) -> Array:
    """The exact equilibrium next to the one that the run found; it must be stable."""
    # A coarse chain is off by the square of its elements; another branch by far more.
    near = 0.03 + 25.0 / drawing.nodes**2
    try:
        state = mesh.follow()
        if _distance(mesh, drawing, state, nodes) < near:
            return state
    except NoSolutionError:
        pass
    try:
        state = mesh.newton(_guess(mesh, drawing, nodes, tension), limit=80, longest=0.3)
    except NoSolutionError as error:
        raise UnsolvedError("no solution near the shape that was found") from error
    distance = _distance(mesh, drawing, state, nodes)
    if distance > near:
        raise UnsolvedError(f"the nearest solution is {distance:.2g} L away")
    squares = mesh.vibrations(state)
    if squares[0] < -1e-6 * abs(squares[-1]):
        raise UnsolvedError("the solution next to the shape that was found is unstable")
    return state


def _distance(mesh: Mesh, drawing: Drawing, state: Array, nodes: Array) -> float:
    exact = np.array([mesh.read(state, float(u))[:2] for u in drawing.node_u])
    return float(np.abs(exact - nodes).max() / mesh.L)


def _guess(mesh: Mesh, drawing: Drawing, nodes: Array, tension: tuple[Array, Array]) -> Array:
    """Splines through a chain's nodes: shape, direction, moment and force."""
    path = CubicSpline(drawing.node_u, nodes)
    u = mesh.u_nodes
    slope, second = path(u, 1), path(u, 2)
    state = np.zeros((*u.shape, 6))
    state[..., :2] = path(u) / mesh.L
    chain = np.unwrap(np.arctan2(path(drawing.node_u, 1)[:, 1], path(drawing.node_u, 1)[:, 0]))
    drawn = mesh.drawn()[..., 2]
    about = np.interp(u, drawing.node_u, chain)
    # Both count full turns from the drawn direction at the first node, as far as that is known.
    about += 2 * np.pi * np.round((drawn.ravel()[0] - about.ravel()[0]) / (2 * np.pi))
    angle = np.arctan2(slope[..., 1], slope[..., 0])
    state[..., 2] = angle + 2 * np.pi * np.round((about - angle) / (2 * np.pi))
    speed = np.hypot(slope[..., 0], slope[..., 1])
    bend = (slope[..., 0] * second[..., 1] - slope[..., 1] * second[..., 0]) / speed**3
    rest = (mesh.rod.natural or (lambda at: mesh.rod.curve(at)[2]))(u)
    state[..., 5] = (bend - rest) * mesh.L
    third = np.gradient(state[..., 5].ravel(), u.ravel() / mesh.L + 1e-13 * np.arange(u.size))
    shear = -third.reshape(u.shape)
    pull = np.interp(u, *tension) / mesh.F
    c, s = np.cos(state[..., 2]), np.sin(state[..., 2])
    state[..., 3], state[..., 4] = pull * c - shear * s, pull * s + shear * c
    return state


def _carry(coarse: Mesh, state: Array, fine: Mesh) -> Array:
    unit = np.array([coarse.L, coarse.L, 1, coarse.F, coarse.F, coarse.F * coarse.L])
    moved = np.empty((fine.pieces, fine.order, 6))
    for i in range(fine.pieces):
        for k, u in enumerate(fine.u_nodes[i]):
            side = -1 if k == fine.order - 1 else 1
            moved[i, k] = coarse.read(state, float(u), side) / unit
    return moved


def value(
    drawing: Drawing, mesh: Mesh, state: Array, probe: dict[str, Any], weight: float = 1.0
) -> float | None:
    """A probe's value, all weight times ``weight``; None where the quantity jumps."""
    quantity = probe["quantity"]
    if quantity in ENERGIES:
        return mesh.energy(state, quantity, weight)
    if "over" in probe:
        return mesh.extreme(state, quantity, probe["reduce"])
    u = place(drawing, probe["at"])
    left, right = (mesh.quantity(state, quantity, u, side) for side in (-1, 1))
    size = scale(mesh, state, quantity)
    if (
        quantity == "curvature"
        and drawing.rod.natural is not None
        and abs(left - right) > 1e-9 / mesh.L
    ):
        return None
    if abs(left - right) > 1e-9 * size:
        return None  # the quantity jumps here
    return right


def place(drawing: Drawing, at: Any) -> float:
    """The parameter of a probe's or support's place."""
    if at == "start":
        return float(drawing.node_u[0])
    if at == "end":
        return float(drawing.node_u[-1])
    if at == "middle":
        return drawing.u(drawing.length / 2)
    if isinstance(at, dict):
        return float(drawing.node_u[at["node"]])
    return drawing.u(float(at))


def scale(mesh: Mesh, state: Array, quantity: str, weight: float = 1.0) -> float:
    """The size that is natural for the quantity in this solution."""
    if quantity in ("x", "y"):
        return float(np.abs(state[..., :2]).max() * mesh.L)
    moment = float(np.abs(state[..., 5]).max()) + 1e-12
    if quantity == "moment":
        return moment * mesh.F * mesh.L
    if quantity == "curvature":
        return (moment + float(np.abs(mesh.kappa_rest).max())) / mesh.L
    force = float(np.hypot(state[..., 3], state[..., 4]).max()) * mesh.F
    # An edge's length is rounded to 1e-16 of the coordinates.
    force += 1e-5 * mesh.rod.EA * float(np.abs(state[..., :2]).max())
    if quantity == "tension":
        return force
    if quantity == "strain":
        return force / mesh.rod.EA
    return float(
        max(abs(mesh.energy(state, "elastic_energy")), abs(mesh.energy(state, quantity, weight)))
    )
