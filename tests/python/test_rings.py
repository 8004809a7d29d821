"""Closed rods in Python: lines that come back to their first node, and refined rings."""

from fractions import Fraction

import der
import numpy as np
import pytest
from der.accuracy.refinement import with_elements
from der.accuracy.resampling import resample
from der.exporting.vtk_series import _Surfaces
from der.fields import rod_fields
from der.sections import at_nodes, directors_along, sections_of, swept
from der.viewing.payload import make_payload

COUNT = 16


def circle(count):
    angle = 2 * np.pi * np.arange(count) / count
    return np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])


def pressed(count=COUNT):
    """A strip bent to a ring, pressed by its weight."""
    return {
        "title": "Ring",
        "model": "spatial",
        "rods": [
            {
                "name": "ring",
                "points": circle(count).tolist(),
                "closed": True,
                "cross_section": {"rectangle": {"width": 0.2, "height": 0.05}},
                "material": {"youngs_modulus": 1e6, "poissons_ratio": 0.3, "density": 1000},
            }
        ],
        "supports": [
            {"rod": "ring", "at": {"node": 3 * count // 4}, "clamp": True},
        ],
        "loads": [{"gravity": [0, -1, 0]}],
        "analysis": "static",
        "output": {"probes": {"y": {"rod": "ring", "at": {"node": count // 4}, "quantity": "y"}}},
    }


@pytest.fixture(scope="module")
def result():
    return der.run(pressed())


def test_its_line_comes_back(result):
    (rod,) = result.rods
    assert rod.closed
    assert len(rod.nodes) == COUNT
    assert rod.line_nodes.tolist() == [*range(COUNT), 0]
    assert rod.line_arc_lengths[-1] == pytest.approx(rod.length)
    (fields,) = rod_fields(result)
    for name, values in fields.at_nodes.items():
        assert values.shape[1] == COUNT + 1
        # The tension is continued to the start from either side.
        digits = 1e-2 if name in ("strain", "tension") else 1e-9
        assert values[:, -1] == pytest.approx(values[:, 0], rel=digits)


def test_run_folder_knows_that_it_is_closed(result, tmp_path):
    result.save(tmp_path / "run")
    assert der.open_run(tmp_path / "run").rods[0].closed


def test_view_shows_the_closing_edge(result):
    (rod,) = make_payload(result)["rods"]
    assert rod["nodes"] == COUNT + 1


def test_sections_meet(result):
    """The surface around a ring is closed: its two ends are the same, and it has no caps."""
    (rod,) = result.rods
    line = result.positions[-1][rod.line_nodes]
    (section,), (directors,) = sections_of(result), directors_along(result)
    corners = swept(line, directors[-1], section.outline)
    assert corners.shape[0] == COUNT + 1
    assert corners[-1] == pytest.approx(corners[0], abs=1e-12)
    surfaces = _Surfaces([section], [rod])
    assert len(surfaces.cell_rods) == 4 * COUNT


def test_directors_that_are_glued_turned_have_no_mean():
    half_turn = np.linspace(0.0, np.pi, 9)[:, None]
    directors = np.cos(half_turn) * [0, 0, 1] + np.sin(half_turn) * [0, 1, 0]
    along = at_nodes(directors, closed=True)
    assert along[0] == pytest.approx(directors[0])
    assert along[-1] == pytest.approx(directors[-1])


def test_figures_and_exports(result, tmp_path):
    result.plot("shapes")
    lines, surfaces = result.export("vtk", tmp_path / "vtk")
    assert lines.exists()
    assert surfaces.exists()
    nodes = result.export("csv", tmp_path / "csv")[0].read_text().splitlines()
    assert len(nodes) == 1 + len(result.times) * (COUNT + 1)


def test_refined_rings_stay_round():
    fine = resample(circle(12), Fraction(3), closed=True)
    assert fine.shape == (36, 3)
    assert fine[::3] == pytest.approx(circle(12), abs=1e-12)
    assert np.linalg.norm(fine, axis=1) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("first", [0, 1, 3])
def test_refined_corners_of_rings_stay_corners(first):
    square = np.array([[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1.0]])
    fine = resample(np.roll(square, -first, axis=0), Fraction(2), closed=True)
    assert fine.shape == (16, 2)
    on_side = (np.abs(fine - 1) == 1).any(axis=1)
    assert on_side.all()


@pytest.mark.parametrize("first", [0, 3])
def test_refined_straight_sides_of_rings_stay_straight(first):
    """Two straight sides and two half circles, from a junction on and from within a side."""
    angle = np.linspace(0.0, np.pi, 13)[:-1]
    arc = np.column_stack([1.0 + 0.3 * np.sin(angle), -0.3 * np.cos(angle)])
    side = np.column_stack([np.arange(8) / 8, np.full(8, -0.3)])
    half = np.vstack([side, arc])
    ring = np.vstack([half, [1.0, 0.0] - half])
    fine = resample(np.roll(ring, -first, axis=0), Fraction(4), closed=True)
    fine = np.roll(fine, 4 * first, axis=0)
    assert fine[::4] == pytest.approx(ring, abs=1e-12)
    assert fine[:33, 1] == pytest.approx(-0.3, abs=1e-12)
    assert np.linalg.norm(fine[32:81] - [1.0, 0.0], axis=1) == pytest.approx(0.3, abs=1e-4)


def test_places_on_a_refined_ring():
    scene = pressed()
    scene["rods"][0]["natural_twist"] = np.cos(2 * np.pi * np.arange(COUNT) / COUNT).tolist()
    scene["output"]["probes"]["last"] = {"rod": "ring", "at": {"node": -1}, "quantity": "y"}
    finer = with_elements(der.Scenario.from_dict(scene), 2).to_dict()
    assert len(finer["rods"][0]["points"]) == 2 * COUNT
    assert len(finer["rods"][0]["natural_twist"]) == 2 * COUNT
    assert finer["rods"][0]["natural_twist"][-1] == pytest.approx(1.0, abs=0.05)
    assert finer["supports"][0]["at"] == {"node": 3 * COUNT // 2}
    assert finer["output"]["probes"]["last"]["at"] == {"node": -2}


def test_bars_hold_for_rings():
    verification = der.verify(pressed())
    text = str(verification)
    assert f"{COUNT} nodes, {2 * COUNT} nodes" in text
    (value,) = verification.values
    fine = der.run(pressed(8 * COUNT)).probes["y"][-1]
    assert abs(value.value - fine) < value.error_bar
