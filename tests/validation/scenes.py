"""Scenes that several validation tests vary: one rod of length 1, most with EI = 1."""

from __future__ import annotations

from typing import Any

import der
import numpy as np

Scene = dict[str, Any]

START, END = {"rod": "rod", "at": "start"}, {"rod": "rod", "at": "end"}
SUPPORTS: dict[str, list[Scene]] = {
    "pinned-pinned": [{**START, "fix": ["x", "y"]}, {**END, "fix": ["y"]}],
    "clamped-free": [{**START, "clamp": True}],
    "clamped-pinned": [{**START, "clamp": True}, {**END, "fix": ["y"]}],
    "clamped-clamped": [{**START, "clamp": True}, {**END, "clamp": True}],
    "free-free": [],
}


def straight(edges: int, ends: str, EA: float = 1e8, **more: Any) -> Scene:
    """A straight rod from (0, 0) to (1, 0) of mass 1."""
    section = {"stiffness": {"EA": EA, "EI": 1.0, "mass_per_length": 1.0}}
    rod = {
        "name": "rod",
        "nodes": edges + 1,
        "from": [0, 0],
        "to": [1, 0],
        "cross_section": section,
    }
    return {"rods": [rod], "supports": SUPPORTS[ends], "analysis": "static", **more}


def tip_force(*force: float) -> list[Scene]:
    """A dead force at the end."""
    return [{"point_force": {**END, "force": list(force)}}]


def arch(edges: int, rise: float, EA: float = 1e4) -> Scene:
    """A pinned circular arch of span 1, stress-free, with 1 N down at its middle."""
    radius = (0.25 + rise**2) / (2 * rise)
    angle = np.linspace(1, -1, edges + 1) * np.arcsin(0.5 / radius)
    points = np.column_stack([0.5 - radius * np.sin(angle), radius * (np.cos(angle) - 1) + rise])
    points[[0, -1]] = [[0, 0], [1, 0]]
    rod = {
        "name": "rod",
        "points": points.tolist(),
        "cross_section": {"stiffness": {"EA": EA, "EI": 1.0, "mass_per_length": 1.0}},
    }
    return {
        "rods": [rod],
        "supports": [{**START, "fix": ["x", "y"]}, {**END, "fix": ["x", "y"]}],
        "loads": [{"point_force": {"rod": "rod", "at": "middle", "force": [0, -1]}}],
        "analysis": "static",
        "output": {"probes": {"middle": {"rod": "rod", "at": "middle", "quantity": "y"}}},
    }


def buckled(edges: int, ends: str, shortening: float = 0.02, EA: float = 1e4) -> Scene:
    """A straight beam whose ends have come together, with 1 N at its middle against its bow."""
    scene = straight(edges, "clamped-clamped", EA)
    hold: Scene = {"clamp": True} if ends == "clamped" else {"fix": ["x", "y"]}
    slide: Scene = {"clamp": True} if ends == "clamped" else {"fix": ["y"]}
    scene["supports"] = [{**START, **hold}, {**END, **slide, "prescribe": {"x": -shortening}}]
    side = np.sign(der.equilibrium(scene).positions[-1, edges // 2, 1])
    force = [0, -float(side)]
    scene["loads"] = [{"point_force": {"rod": "rod", "at": "middle", "force": force}}]
    scene["output"] = {"probes": {"middle": {"rod": "rod", "at": "middle", "quantity": "y"}}}
    return scene


def swing(nodes: int, **time: Any) -> Scene:
    """A soft clamped rod that swings down from the horizontal under its weight, for a second."""
    rod = {
        "name": "arm",
        "nodes": nodes,
        "from": [0, 0],
        "to": [1, 0],
        "cross_section": {"circle": {"radius": 0.01}},
        "material": {"youngs_modulus": 1e7, "density": 1000},
    }
    return {
        "title": "Swing",
        "rods": [rod],
        "supports": [{"rod": "arm", "at": "start", "clamp": True}],
        "loads": [{"gravity": [0, -9.81]}],
        "time": {"duration": 1.0, **time},
        "output": {"every": 0.01},
    }
