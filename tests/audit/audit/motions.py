"""Scenes over time: rods that swing, fly, turn with their clamp; and closed forms of falling."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .case import Case, Label, Truth
from .ritz import Motion, Ritz
from .rod import Array
from .shapes import Random, power

STEPPERS = (
    "tr_bdf2",
    "tr_bdf2",
    "tr_bdf2",
    "implicit_midpoint",
    "generalized_alpha",
    "newmark",
    "bdf2",
    "sdirk4",
    "sdirk5",
    "implicit_euler",
    "verlet",
)
FIELDS = ("x", "y", "x", "y", "vx", "vy", "speed", "moment", "tension", "strain", "curvature")
ENERGIES = (
    "kinetic_energy",
    "elastic_energy",
    "bend_energy",
    "stretch_energy",
    "spring_energy",
    "gravity_energy",
    "total_energy",
)


def motion(rng: Random) -> Case:
    L = power(rng, -8, 3) if rng.random() < 0.5 else 1.0
    EI = power(rng, -3, 3) * L**4
    ratio = power(rng, 2.7, 4.5)
    mu = power(rng, -2, 1) * L**2
    T, F = L**2 * np.sqrt(mu / EI), EI / L**2
    hold = str(rng.choice(["clamp", "clamp", "clamp", "pin", "free", "spin"]))
    system = Motion(EA=ratio, hold="clamp" if hold == "spin" else hold)
    phi = float(rng.choice([0.0, rng.uniform(-np.pi, np.pi)]))
    c, s = np.cos(phi), np.sin(phi)
    out = np.array([[c, -s], [s, c]])  # from the rod's axes to the scene's
    origin = rng.uniform(-1, 1, 2) * L if rng.random() < 0.3 else np.zeros(2)
    nodes = int(rng.choice([7, 11, 15, 21, 31]))
    duration = float(rng.uniform(0.2, 1.0))

    rod: dict[str, Any] = {
        "name": "rod",
        "nodes": nodes,
        "from": origin.tolist(),
        "to": (origin + L * out[:, 0]).tolist(),
        "cross_section": {"stiffness": {"EA": ratio * F, "EI": EI, "mass_per_length": mu}},
    }
    scene: dict[str, Any] = {"title": "Audit: motion", "rods": [rod], "supports": [], "loads": []}
    loads = scene["loads"]
    if hold in ("clamp", "spin"):
        scene["supports"].append({"rod": "rod", "at": "start", "clamp": True})
    elif hold == "pin":
        scene["supports"].append({"rod": "rod", "at": "start", "fix": ["x", "y"]})
    else:
        del scene["supports"]
    arc = np.linspace(0, 1, nodes)
    if hold == "spin":
        # The clamp turns evenly, and the rod with it from the start: no jump.
        system.spin = float(rng.uniform(-4, 4))
        turned = system.spin * duration
        scene["supports"][0]["prescribe"] = {
            "angle": {"times": [0, duration * T], "values": [0, turned]}
        }
        start = np.outer(system.spin * arc, out[:, 1]) * L / T
        rod["initial_velocity"] = start.tolist()
    if hold in ("pin", "free") and rng.random() < 0.7:
        system.rate = float(rng.uniform(-3, 3))
        velocity = rng.uniform(-1, 1, 2) if hold == "free" else np.zeros(2)
        system.velocity = (float(velocity[0]), float(velocity[1]))
        local = np.column_stack([0 * arc + velocity[0], velocity[1] + system.rate * arc])
        rod["initial_velocity"] = (local @ out.T * L / T).tolist()
    if rng.random() < 0.6:
        g = rng.uniform(-3, 3, 2)
        system.gravity = (float(g[0]), float(g[1]))
        loads.append({"gravity": (out @ g * F / L / mu).tolist()})
    if rng.random() < 0.3:
        q = rng.uniform(-3, 3, 2)
        system.line = (float(q[0]), float(q[1]))
        loads.append({"distributed_force": {"rod": "rod", "force": (out @ q * F / L).tolist()}})
    if hold != "spin" and rng.random() < 0.3:
        k = 10.0 ** rng.uniform(0, 3, 2)
        k[rng.random(2) < 0.2] = 0.0
        if k.any():
            system.foundation = out.T @ np.diag(k) @ out
            stiffness = (k * F / L**2).tolist()
            loads.append({"foundation": {"rod": "rod", "stiffness": stiffness}})
    if rng.random() < 0.5 or not (loads or rod.get("initial_velocity")):
        _force(rng, system, duration, loads, out, T, F)
    if hold != "spin" and rng.random() < 0.4:
        system.damping = float(rng.uniform(0.2, 5))
        loads.append({"damping": {"coefficient": system.damping * mu / T}})
    if rng.random() < 0.3:
        system.end_mass = float(rng.uniform(0.1, 1))
        radius = 0.03 * L
        density = system.end_mass * mu * L / (4 / 3 * np.pi * radius**3)
        rod["spheres"] = [{"at": "end", "radius": radius, "density": density}]
    if rng.random() < 0.15 and hold == "clamp":
        system.kappa = float(rng.uniform(-1, 1))
        rod["natural_curvature"] = system.kappa / L
    if hold == "clamp" and rng.random() < 0.3:
        system.settled = True
        scene["start_from"] = "equilibrium"
    if not loads:
        del scene["loads"]
    scene["time"] = _stepping(rng, duration * T, T)
    probes = _probes(rng, nodes, L)
    scene["output"] = {"probes": probes}

    units = {
        **dict.fromkeys(("x", "y"), L),
        **dict.fromkeys(("vx", "vy", "speed"), L / T),
        "moment": F * L,
        "tension": F,
        "strain": 1.0,
        "curvature": 1 / L,
    }

    def series(degree: int, steps: int) -> tuple[Array, dict[str, Array]]:
        ritz = Ritz(system, degree)
        times, z, v = ritz.run(duration, steps)
        found = {}
        for name, probe in probes.items():
            quantity = probe["quantity"]
            place = _place(probe.get("at", "start"), arc, L)

            def values(what: str, place: float = place) -> Array:
                at = zip(times, z, v, strict=True)
                return np.array([ritz.read(t, a, b, what, place) for t, a, b in at])

            if quantity in ("x", "y", "vx", "vy"):
                first = "x" if len(quantity) == 1 else "vx"
                both = np.stack([values(first), values(first.replace("x", "y"))])
                row = 0 if quantity.endswith("x") else 1
                found[name] = (out @ both)[row] * units[quantity]
                if len(quantity) == 1:
                    found[name] += origin[row]
            elif quantity in ENERGIES:
                found[name] = values(quantity) * F * L
                if quantity in ("gravity_energy", "total_energy"):
                    mass = 1 + system.end_mass
                    found[name] -= mass * float(np.array(system.gravity) @ (out.T @ origin)) * F
            else:
                found[name] = values(quantity) * units[quantity]
        return times, found

    def truths(_: dict[str, Any]) -> Mapping[Label, Truth]:
        return compare(series(10, 80), series(16, 280), probes)

    return Case("motion", scene, truths)


def _place(at: Any, arc: Array, L: float) -> float:
    """The dimensionless arc length of a probe."""
    if isinstance(at, dict):
        return float(arc[at["node"]])
    if isinstance(at, str):
        return {"start": 0.0, "middle": 0.5, "end": 1.0}[at]
    return float(at) / L


def _force(
    rng: Random, system: Motion, duration: float, loads: list[Any], out: Array, T: float, F: float
) -> None:
    """A force at the end, constant or by a table."""
    f = rng.uniform(-3, 3, 2)
    if rng.random() < 0.4:
        system.force = lambda t: f
        force: Any = (out @ f * F).tolist()
    else:
        corner = float(rng.uniform(0.2, 0.6) * duration)
        stop = corner + float(rng.uniform(0.1, 0.5) * duration)
        a, b = (f, 0 * f) if rng.random() < 0.5 else (0 * f, f)
        system.force = lambda t: a + (b - a) * np.clip((t - corner) / (stop - corner), 0, 1)
        system.kinks = (corner, stop)
        force = {
            "times": [corner * T, stop * T],
            "values": [(out @ a * F).tolist(), (out @ b * F).tolist()],
        }
    loads.append({"point_force": {"rod": "rod", "at": "end", "force": force}})


def _stepping(rng: Random, duration: float, T: float) -> dict[str, Any]:
    if rng.random() < 0.25:
        return {"duration": duration, "tolerance": power(rng, -4, -2.3)}
    stepper = str(rng.choice(STEPPERS))
    time: dict[str, Any] = {"duration": duration, "integrator": stepper}
    steps = int(rng.choice([50, 100, 200, 400]))
    time["step"] = "auto" if stepper == "verlet" else duration / steps
    return time


def _probes(rng: Random, nodes: int, L: float) -> dict[str, dict[str, Any]]:
    probes: dict[str, dict[str, Any]] = {}
    for i in range(int(rng.integers(3, 6))):
        if rng.random() < 0.25:
            probes[f"p{i}"] = {"quantity": str(rng.choice(ENERGIES))}
            continue
        quantity = str(rng.choice(FIELDS))
        at: Any = str(rng.choice(["middle", "end"]))
        if quantity in ("moment", "curvature"):
            at = rng.choice(["start", "node"])
        if at == "node" or rng.random() < 0.3:
            at = {"node": int(rng.integers(2, nodes - 2))}
        elif quantity not in ("moment", "curvature") and rng.random() < 0.5:
            at = float(rng.uniform(0, 1) * L)
        at = str(at) if isinstance(at, str) else at
        probes[f"p{i}"] = {"rod": "rod", "quantity": quantity, "at": at}
    return probes


def compare(
    rough: tuple[Array, dict[str, Array]],
    fine: tuple[Array, dict[str, Array]],
    probes: dict[str, dict[str, Any]],
) -> dict[Label, Truth]:
    """Final values and extremes of a finer solution; their error is from a rougher one.

    The two must be far apart. A load that acts suddenly sends waves of all lengths along the rod,
    and two solutions that are both too rough for them agree on an extreme that neither has.
    """
    found: dict[Label, Truth] = {}
    for name, values in fine[1].items():
        other = rough[1][name]
        span = float(np.abs(values).max())
        pairs = {
            "final": (float(other[-1]), float(values[-1])),
            "min": (-_greatest(rough[0], -other), -_greatest(fine[0], -values)),
            "max": (_greatest(rough[0], other), _greatest(fine[0], values)),
        }
        for what, (a, b) in pairs.items():
            error = 2 * abs(b - a) + 1e-9 * span
            found[name, what] = Truth(b, error, max(span, 1e-300), probes[name]["quantity"])
    return found


def _greatest(times: Array, values: Array) -> float:
    """The greatest value over time: that of the parabola through the samples around it."""
    k = int(values.argmax())
    if 0 < k < len(values) - 1:
        fit = np.polynomial.Polynomial.fit(times[k - 1 : k + 2], values[k - 1 : k + 2], 2)
        roots = fit.deriv().roots().real
        if len(roots) and times[k - 1] < roots[0] < times[k + 1]:
            return float(max(fit(roots[0]), values[k]))
    return float(values[k])


# -- closed forms ---------------------------------------------------------------------------------


def fall(rng: Random) -> Case:
    """A rod in free flight with damping, or spheres in a fluid: one ordinary differential equation.

    ``m v' = f - k v`` for each component.
    """
    L = power(rng, -8, 3) if rng.random() < 0.6 else 1.0
    nodes = int(rng.integers(3, 20))
    EI = power(rng, -3, 3) * L**4
    g = rng.uniform(-10, 10, 2)
    phi = rng.uniform(-np.pi, np.pi)
    in_fluid = rng.random() < 0.5
    tau = power(rng, -2, 0) * np.sqrt(L)  # of the drag
    duration = float(rng.uniform(0.2, 4) * tau)
    mu = power(rng, -2, 1) * L**2
    rod: dict[str, Any] = {
        "name": "rod",
        "nodes": nodes,
        "from": [0, 0],
        "to": [float(L * np.cos(phi)), float(L * np.sin(phi))],
    }
    loads: list[Any] = [{"gravity": g.tolist()}]
    v0 = np.zeros(2)
    if in_fluid:
        radius = 0.2 * L / nodes
        density = power(rng, 3, 4)
        mass = 4 / 3 * np.pi * radius**3 * density
        viscosity = mass / tau / (6 * np.pi * radius)
        buoyant = float(rng.choice([0.0, rng.uniform(0, 0.9)]))
        rod["spheres"] = [{"at": "all", "radius": radius, "density": density}]
        loads.append({"fluid": {"density": buoyant * density, "viscosity": viscosity}})
        mu, whole = 0.0, mass * nodes
    else:
        buoyant = 0.0
        loads.append({"damping": {"coefficient": mu / tau}})
        v0 = rng.uniform(-3, 3, 2) * np.hypot(*g) * tau
        rod["initial_velocity"] = v0.tolist()
        whole = mu * L
    stiffness = {"EA": EI / L**2 * 1e4, "EI": EI, "mass_per_length": mu}
    rod["cross_section"] = {"stiffness": stiffness}
    stepper = str(rng.choice(STEPPERS[:-1]))
    steps = int(rng.choice([20, 50, 200]))
    share = float(rng.uniform(0, 1))
    probes = {
        quantity: {"rod": "rod", "at": share * L, "quantity": quantity}
        for quantity in ("x", "y", "vx", "vy", "speed")
    }
    probes["kinetic"] = {"quantity": "kinetic_energy"}
    probes["weight"] = {"quantity": "gravity_energy"}
    scene = {
        "title": "Audit: fall",
        "rods": [rod],
        "loads": loads,
        "time": {"duration": duration, "step": duration / steps, "integrator": stepper},
        "output": {"probes": probes},
    }
    if rng.random() < 0.25:
        scene["time"] = {"duration": duration, "tolerance": power(rng, -5, -2)}
    pull = g * (1 - buoyant)

    def velocity(t: Array) -> Array:
        return np.asarray(pull * tau + (v0 - pull * tau) * np.exp(-t[:, None] / tau))

    def shift(t: Array) -> Array:
        gone = -np.expm1(-t[:, None] / tau)
        return np.asarray(pull * tau * t[:, None] + (v0 - pull * tau) * tau * gone)

    def truths(_: dict[str, Any]) -> Mapping[Label, Truth]:
        t = np.linspace(0, duration, 20001)
        x, v = shift(t), velocity(t)
        along = np.array([np.cos(phi), np.sin(phi)])
        here = x + share * L * along
        rows: dict[str, tuple[Array, str]] = {
            "x": (here[:, 0], "x"),
            "y": (here[:, 1], "y"),
            "vx": (v[:, 0], "vx"),
            "vy": (v[:, 1], "vy"),
            "speed": (np.hypot(*v.T), "speed"),
            "kinetic": (whole * (v**2).sum(axis=1) / 2, "kinetic_energy"),
            "weight": (-whole * (x + L / 2 * along) @ g, "gravity_energy"),
        }
        found: dict[Label, Truth] = {}
        for name, (values, quantity) in rows.items():
            span = float(np.abs(values).max())
            for what, value in (
                ("final", values[-1]),
                ("min", -_greatest(t, -values)),
                ("max", _greatest(t, values)),
            ):
                # A speed has a corner where both components vanish.
                found[name, what] = Truth(float(value), 1e-8 * span, span, quantity)
        return found

    return Case("fall", scene, truths)
