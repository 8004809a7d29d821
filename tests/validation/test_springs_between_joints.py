"""Springs between joints (`springs`), against closed forms and `references/networks.py`."""

from __future__ import annotations

from typing import Any

import der
import numpy as np
import pytest
from network_scenes import at, clamp, force, joint, scene_of
from references.networks import Network, Scene
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

AXES = {2: ["x", "y"], 3: ["x", "y", "z"]}


def vector(dimension: int, *components: float) -> list[float]:
    return [*components, 0.0][:dimension] if dimension == 2 else [*components, 0.0][:3]


def rod(dimension: int, name: str, start: list[float], end: list[float], nodes: int, **k: float):
    stiffness: Scene = {"EA": 1e6, "EI": 1.0, "mass_per_length": 1.0} | k
    section: Scene = {"stiffness": stiffness}
    if dimension == 3:
        EI = stiffness.pop("EI")
        if EI > 0:
            stiffness |= {"EI1": EI, "EI2": EI, "GJ": EI, "rotary_inertia": 1e-6}
            section["director"] = [0.1, 0.2, 1.0]
        else:
            stiffness |= {"EI": 0.0, "GJ": 1.0, "rotary_inertia": 1e-3}
    ends = {"from": vector(dimension, *start), "to": vector(dimension, *end)}
    return {"name": name, "nodes": nodes, "cross_section": section} | ends


def anchored(dimension: int, beam: Scene, point: list[float], spring: Scene) -> Scene:
    """A rod that is clamped at its start, with a spring from its end to a point that is held."""
    post = rod(dimension, "post", point, [point[0] + 0.1, point[1] + 0.1], 3)
    scene = scene_of(
        [beam, post],
        [joint("tip", at(beam["name"], "end")), joint("anchor", at("post", "start"))],
        [clamp(beam["name"], "start"), clamp("post", "start")],
        [],
    )
    return scene | {"springs": [{"name": "spring", "between": ["tip", "anchor"], **spring}]}


@pytest.mark.parametrize("dimension", [2, 3])
def test_frequencies_of_a_cantilever_on_a_spring(dimension: int, fitted_order: Any) -> None:
    """b^3 (1 + cos b cosh b) + k (sin b cosh b - cos b sinh b) = 0 with k in EI/L^3, as of any
    beam on an elastic support, such as in Blevins, Formulas for Natural Frequency, 1979, ch. 8."""
    k = 7.0

    def characteristic(b: float) -> float:
        c, s, ch, sh = np.cos(b), np.sin(b), np.cosh(b), np.sinh(b)
        return float(b**3 * (1 + c * ch) + k * (s * ch - c * sh))

    exact = np.array([brentq(characteristic, *bounds) for bounds in ((1.6, 3.0), (4.5, 5.5))])
    errors = []
    for n in (11, 21, 41):
        beam = rod(dimension, "beam", [0, 0], [1, 0], n)
        scene = anchored(dimension, beam, [1, -0.7], {"stiffness": k})
        simulation = der.Simulation(scene | {"analysis": "static"})
        simulation.equilibrium()
        found = simulation.modes(8).frequencies * 2 * np.pi
        # In space each mode is there out of the plane, too, where the spring does nothing.
        near = found[np.argmin(np.abs(found[:, np.newaxis] - exact**2), axis=0)]
        errors.append(np.abs(near / exact**2 - 1).max())
    assert errors[-1] < 1e-3
    assert fitted_order([1 / 10, 1 / 20, 1 / 40], errors) > 1.85, errors


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("integrator", ["implicit_midpoint", "generalized_alpha", "sdirk4"])
def test_a_mass_on_a_spring_and_a_damper(
    dimension: int, integrator: str, fitted_order: Any
) -> None:
    """A cable of little mass and stiffness guides a heavy sphere, which a shorter spring pulls."""
    k, c, m, rest = 30.0, 2.0, 1.5, 0.8
    cable = rod(dimension, "cable", [0, 0], [1, 0], 3, EA=2.0, EI=0.0, mass_per_length=1e-9)
    volume = 4 / 3 * np.pi * 0.01**3
    cable["spheres"] = [{"at": "end", "radius": 0.01, "density": m / volume}]
    scene = anchored(dimension, cable, [2, 0], {"stiffness": k, "rest_length": rest, "damping": c})
    scene["supports"].append({"rod": "cable", "at": {"node": 1}, "fix": AXES[dimension]})
    scene["supports"].append({"joint": "tip", "fix": AXES[dimension][1:]})
    scene["output"] = {"probes": {"x": {"joint": "tip", "quantity": "x"}}}
    scene["output"]["probes"]["pull"] = {"spring": "spring", "quantity": "spring_force"}
    total = k + 2.0 / 0.5
    mean, rate = k * (1 - rest) / total, c / (2 * m)
    omega = np.sqrt(total / m - rate**2)
    t = 1.0
    wave = np.cos(omega * t) + rate / omega * np.sin(omega * t)
    moved = mean * (1 - np.exp(-rate * t) * wave)
    speed = mean * np.exp(-rate * t) * (omega + rate**2 / omega) * np.sin(omega * t)
    errors = []
    counts = (25, 50, 100) if integrator == "sdirk4" else (50, 100, 200)
    for steps in counts:
        time = {"duration": t, "step": t / steps, "integrator": integrator}
        probes = der.run(scene | {"time": time}).probes
        pull = k * (1 - moved - rest) - c * speed
        errors.append(max(abs(probes["x"][-1] - 1 - moved), abs(probes["pull"][-1] - pull) / k))
    assert errors[-1] < 1e-3
    order = 4 if integrator == "sdirk4" else 2
    assert fitted_order([1 / count for count in counts], errors) > order - 0.15, errors


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_tendon_follows_time_and_programs(dimension: int) -> None:
    """A table or a program leads to the equilibrium of a scene with that rest length."""
    beam = rod(dimension, "beam", [0, 0], [1, 0], 11, EA=1e4)

    def tendon(rest: Any, **more: Any) -> Scene:
        scene = anchored(
            dimension, beam, [0.1, 0.6], {"stiffness": 20.0, "rest_length": rest, "damping": 3.0}
        )
        probes = {"pull": {"spring": "spring", "quantity": "spring_force"}}
        probes["length"] = {"spring": "spring", "quantity": "spring_length"}
        return scene | {"output": {"probes": probes}} | more

    exact = der.run(tendon(0.6, analysis="static"))
    assert exact.probes["pull"][-1] > 2.0
    assert exact.probes["pull"][-1] == pytest.approx(20 * (exact.probes["length"][-1] - 0.6))
    time = {"duration": 60, "step": 0.05, "integrator": "implicit_euler"}
    slow = der.run(tendon({"times": [0, 5], "values": [1.0, 0.6], "smooth": True}, time=time))
    assert slow.positions[-1] == pytest.approx(exact.positions[-1], abs=1e-6)
    assert slow.probes["pull"][-1] == pytest.approx(exact.probes["pull"][-1], abs=1e-5)
    simulation = der.Simulation(tendon(1.0, time=time))
    assert simulation.names["spring"] == {"rest_length": "m"}
    simulation.set("spring", 0.6)
    simulation.step(1200)
    assert simulation.positions == pytest.approx(exact.positions[-1], abs=1e-6)


def test_a_compressed_spring_on_a_column_pushes_it_over(fitted_order: Any) -> None:
    """From its tip down to a point, it bears a share S of the load, and S over its length h
    pushes the tip aside. A column
    with a force N whose tip is held by a stiffness c across buckles at tan u = u (1 - N / (c L)),
    u = L sqrt(N / EI) (Timoshenko and Gere, Theory of Elastic Stability, 1961), here c = -S/h."""
    EA, k, h = 500.0, 300.0, 0.4
    share = k / (k + EA)

    def characteristic(u: float) -> float:
        N = u**2
        c = -N * share / (1 - share) / h
        return float(np.sin(u) - u * (1 - N / c) * np.cos(u))

    u = brentq(characteristic, 0.3, 1.57)
    exact = u**2 / (1 - share)
    errors = []
    for n in (11, 21, 41):
        column = rod(2, "column", [0, 0], [0, 1], n, EA=EA)
        scene = anchored(2, column, [0, 1 - h], {"stiffness": k})
        scene["loads"] = [force("column", "end", 0, -1)]
        result = der.run(scene | {"analysis": {"buckling": {"count": 1}}})
        found = result.buckling.load_factors[0]
        errors.append(abs(found / exact - 1))
    assert errors[-1] < 1e-3, (errors, exact)
    assert fitted_order([1 / 10, 1 / 20, 1 / 40], errors) > 1.85, errors


def test_springs_in_space(fitted_order: Any) -> None:
    """Two cantilevers in a tilted plane with a spring between their tips, as in the plane."""

    def scene(dimension: int, n: int) -> Scene:
        rods = [
            rod(dimension, "a", [0, 0], [1, 0], 8 * n + 1, EA=1e4),
            rod(dimension, "b", [0, 0.5], [0.8, 0.9], 8 * n + 1, EA=1e4, EI=0.6),
        ]
        found = scene_of(
            rods,
            [joint("tip", at("a", "end")), joint("top", at("b", "end"))],
            [clamp("a", "start"), clamp("b", "start")],
            [force("a", "end", *vector(dimension, 0.5, -1.0))],
        )
        spring = {"name": "tie", "between": ["tip", "top"], "stiffness": 9.0, "rest_length": 0.5}
        return found | {"springs": [spring]}

    exact = Network(scene(2, 1)).solve().spring("tie")
    turn = Rotation.from_rotvec([0.3, 0.6, -0.15])
    errors = []
    for n in (1, 2, 4):
        turned = scene(3, n)
        for line in turned["rods"]:
            for key in ("from", "to"):
                line[key] = turn.apply(line[key]).tolist()
        load = turned["loads"][0]["point_force"]
        load["force"] = turn.apply(load["force"]).tolist()
        probes = {
            name: {"spring": "tie", "quantity": f"spring_{name}"} for name in ("length", "force")
        }
        result = der.run(turned | {"analysis": "static", "output": {"probes": probes}})
        found = [result.probes[name][-1] for name in ("length", "force")]
        errors.append(np.abs(np.subtract(found, exact)).max())
    assert errors[-1] < 1e-2
    assert fitted_order([1, 1 / 2, 1 / 4], errors) > 1.85, errors
