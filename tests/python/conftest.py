import copy
import shutil
from typing import Any

import matplotlib as mpl
import pytest
from browsers import FLAGS, missing

mpl.use("agg")

TUBE: dict[str, Any] = {
    "title": "Tube on two supports",
    "rods": [
        {
            "name": "beam",
            "nodes": 21,
            "from": [0, 0],
            "to": [1, 0],
            "cross_section": {"tube": {"inner_radius": 0.011, "outer_radius": 0.013}},
            "material": {"youngs_modulus": 70e9, "density": 2700},
        }
    ],
    "supports": [
        {"rod": "beam", "at": "start", "fix": ["x", "y"]},
        {"rod": "beam", "at": "end", "fix": ["y"]},
    ],
    "loads": [{"point_force": {"rod": "beam", "at": 0.75, "force": [0, -2000]}}],
    "time": {"duration": 0.5, "step": 0.01, "integrator": "implicit_euler"},
    "output": {
        "every": 0.02,
        "probes": {
            "deflection": {"rod": "beam", "quantity": "y", "over": "rod", "reduce": "min"},
            "roller": {"rod": "beam", "at": "end", "quantity": "x"},
        },
    },
}

SWING: dict[str, Any] = {
    "title": "Swinging rod",
    "rods": [
        {
            "name": "arm",
            "nodes": 11,
            "from": [0, 0],
            "to": [1, 0],
            "cross_section": {"circle": {"radius": 0.01}},
            "material": {"youngs_modulus": 1e7, "density": 1000},
        }
    ],
    "supports": [{"rod": "arm", "at": "start", "clamp": True}],
    "loads": [{"gravity": [0, -9.81]}],
    "time": {"duration": 0.2, "step": 0.002, "integrator": "implicit_euler"},
    "output": {"every": 0.01, "probes": {"tip": {"rod": "arm", "at": "end", "quantity": "y"}}},
}

SPHERES: dict[str, Any] = {
    "title": "Three spheres in a fluid",
    "rods": [
        {
            "name": "rod",
            "nodes": 3,
            "from": [0, 0],
            "to": [0.1, 0],
            "cross_section": {"circle": {"radius": 0.001}},
            "material": {"youngs_modulus": 1e9, "density": 0},
            "curvature": "tangent",
            "spheres": [
                {"at": "all", "radius": 0.005, "density": 7000},
                {"at": "middle", "radius": 0.025, "density": 7000},
            ],
        }
    ],
    "loads": [{"gravity": [0, -9.8]}, {"fluid": {"density": 1000, "viscosity": 1000}}],
    "time": {"duration": 1, "step": 0.01, "integrator": "implicit_euler"},
    "output": {
        "probes": {
            "v_mid": {"rod": "rod", "at": "middle", "quantity": "vy"},
            "angle": {"rod": "rod", "at": "middle", "quantity": "turning_angle"},
        }
    },
}

#: A flat strip, straight as drawn, that has a natural helix and falls from a clamp.
HELIX: dict[str, Any] = {
    "title": "A helix let go",
    "model": "spatial",
    "rods": [
        {
            "name": "strip",
            "nodes": 9,
            "from": [0, 0, 0],
            "to": [0.4, 0, 0],
            "cross_section": {
                "rectangle": {"width": 0.02, "height": 0.004},
                "director": [0, 0, 1],
            },
            "material": {"youngs_modulus": 1e8, "poissons_ratio": 0.3, "density": 1000},
            "natural_curvature": [1.5, 4.0],
            "natural_twist": 5.0,
        }
    ],
    "supports": [{"rod": "strip", "at": "start", "clamp": True}],
    "loads": [
        {"gravity": [0, 0, -9.81]},
        {"point_force": {"rod": "strip", "at": "end", "force": [0, 0.02, 0]}},
    ],
    "time": {"duration": 0.04, "step": 0.001, "integrator": "implicit_euler"},
    "output": {"every": 0.004},
}


@pytest.fixture
def tube() -> dict[str, Any]:
    return copy.deepcopy(TUBE)


@pytest.fixture
def swing() -> dict[str, Any]:
    return copy.deepcopy(SWING)


@pytest.fixture
def spheres() -> dict[str, Any]:
    return copy.deepcopy(SPHERES)


@pytest.fixture
def helix() -> dict[str, Any]:
    return copy.deepcopy(HELIX)


@pytest.fixture
def unstable(spheres: dict[str, Any]) -> dict[str, Any]:
    """The explicit scheme with a step at which drag makes it blow up."""
    spheres["time"] = {
        "duration": 1,
        "step": 1e-4,
        "integrator": "explicit_euler",
        "allow_unstable": True,
    }
    return spheres


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    """A headless Chromium; without one the test is skipped, or fails where it is required."""
    try:
        from selenium import webdriver
    except ModuleNotFoundError:
        return missing("selenium (pip install selenium)")
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    driver = shutil.which("chromedriver")
    if not chromium or not driver:
        return missing("Chromium (Debian packages chromium and chromium-driver)")
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for flag in (*FLAGS, f"--user-data-dir={tmp_path_factory.mktemp('chromium')}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    window = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    yield window
    window.quit()
