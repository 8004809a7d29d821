"""`clamp: tangent` inside a rod in space: a bearing, through which the rod spins.

References: `references/bearing.py` for a curved, twisted rod under large loads; beam theory, and
frequencies of beams and shafts in closed form.
"""

import der
import numpy as np
import pytest
from references.bearing import FORCE, MOMENT, SIDES
from references.curved_twisted_rod import NATURAL, rest_position
from scenes import END, START
from spatial_scenes import CLAMPED, measured, rod_through, section, straight_rod

XYZ = ("x", "y", "z")
FINE = [32, 64, 128]
BEARING = {"rod": "rod", "at": "middle", "clamp": "tangent"}
STRIP = section([0, 1, 0], EA=1e6, EI1=3.0, EI2=1.0, GJ=0.8)  # director 1 = y


def force(*components, at="end"):
    return {"point_force": {"rod": "rod", "at": at, "force": list(components)}}


def moment(*components, at="end"):
    return {"moment": {"rod": "rod", "at": at, "moment": list(components)}}


def orders(fitted_order, sizes, errors):
    return np.array([fitted_order([1 / n for n in sizes], e) for e in np.array(errors).T])


@pytest.mark.parametrize("drawn", ["helix", "helix with strains"])
def test_a_curved_twisted_rod_in_a_bearing(spatial_reference, fitted_order, drawn):
    def value(name):
        return spatial_reference("bearing", name)

    # Curvature towards d1 turns about d2, and that towards d2 about -d1.
    strains = [
        [value(f"{side}.curvature_2"), -value(f"{side}.curvature_1"), value(f"{side}.twist")]
        for side in SIDES
    ]
    exact = np.array(
        [
            [value(f"end.{c}") for c in XYZ],
            *[[value(f"{side}.{c}") for c in XYZ] for side in SIDES],
            *strains,
            *[
                [value(f"{support}.{what}.{c}") for c in XYZ]
                for support in ("clamp", "bearing")
                for what in ("force", "moment")
            ],
        ]
    )
    strip = section([1, 0, 0], EA=1e4, EI1=3.0, EI2=1.0, GJ=0.8)
    natural = {"natural_curvature": [NATURAL[1], -NATURAL[0]], "natural_twist": NATURAL[2]}
    given = natural if drawn == "helix with strains" else {}
    errors = []
    for n in FINE:
        points = np.array([rest_position(NATURAL, s) for s in np.linspace(0, 1, n + 1)])
        points /= np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
        scene = rod_through(
            points,
            strip,
            rod={"initial_twist": NATURAL[2], **given},
            supports=[*CLAMPED, BEARING],
            loads=[force(*FORCE), moment(*MOMENT)],
        )
        values, result = measured(scene, ["end", *SIDES.values()])
        bears = [vector[-1] for each in result.reactions() for vector in (each.force, each.moment)]
        found = np.array([*values[:, :3], *values[1:, 3:6], *bears])
        errors.append(np.linalg.norm(found - exact, axis=1))
    assert (orders(fitted_order, FINE, errors) >= 1.9).all()
    last = np.array(errors[-1])
    assert last[:3].max() < 5e-4  # positions; the length is 1
    assert last[3:5].max() < 5e-3  # curvatures and twist of up to 4.5
    # Forces of up to 10: the rod between clamp and bearing has EA = 1e4, and a polygon on the curve
    # is shorter by (kappa h)^2/24 = 2e-5 of its length.
    assert last[5:].max() < 0.2


def test_a_shaft_passes_on_its_torque():
    """A torque at the end twists both halves; a force across bends that beyond the bearing."""
    torque, load = 0.4, 1e-5
    shaft = straight_rod(
        32,
        STRIP,
        supports=[*CLAMPED, BEARING],
        loads=[moment(torque, 0, 0), force(0, load, 2 * load)],
    )
    values, result = measured(shaft, ["end", 0.25, 0.75], ("y", "z", "twist", "torque"))
    assert values[:, 2] == pytest.approx(torque / 0.8, rel=1e-6)
    assert values[:, 3] == pytest.approx(torque, rel=1e-6)
    # The section turns by less than half a radian in all: bending is that of a twisted strip.
    clamp, bearing = result.reactions()
    assert clamp.moment[-1][0] == pytest.approx(-torque, rel=1e-6)
    assert abs(bearing.moment[-1][0]) < 1e-9
    arm = np.cross([0.5, 0, 0], [0, load, 2 * load])
    taken = clamp.moment[-1] + bearing.moment[-1] + np.cross([0.5, 0, 0], bearing.force[-1])
    assert taken[1:] + arm[1:] == pytest.approx(-arm[1:], abs=1e-3 * load)


def test_a_spun_shaft_turns_in_its_bearing():
    """Three whole turns of the clamp come out at the end, less what a torque twists."""
    turns, torque = 6 * np.pi, 0.3
    clamp = {**CLAMPED[0], "prescribe": {"twist": turns}}
    shaft = straight_rod(
        20, STRIP, supports=[clamp, BEARING], loads=[moment(-torque, 0, 0), force(0, 0.02, 0)]
    )
    _, result = measured(shaft, ["end"], ["x"])
    length_to_last_middle = 1 - 0.5 / 20
    turned = turns - torque / 0.8 * length_to_last_middle
    assert result.theta[-1][-1] == pytest.approx(turned, rel=1e-3)


@pytest.mark.parametrize("model", ["planar", "spatial_bend"])
def test_agreement_with_the_models_without_sections(fitted_order, model):
    """They have no spin, and clamp the node: the two differ by the order of both. Curvature has a
    sign in the plane alone."""
    gaps = []
    load = [0.5, -2.0, 0.0 if model == "planar" else 1.5]
    for n in FINE:
        rod = straight_rod(
            n,
            section(EA=1e4, EI=1.0, GJ=0.8),
            supports=[*CLAMPED, BEARING],
            loads=[force(*load)],
        )
        quantities = ["x", "y", "curvature", "z"][: 3 if model == "planar" else 4]
        shapes = [
            np.abs(measured({**rod, "model": kind}, ["end", 0.75, 0.5], quantities)[0])
            for kind in (model, "spatial")
        ]
        gaps.append([np.abs(shapes[0] - shapes[1]).max()])
    assert (orders(fitted_order, FINE, gaps) > 1.9).all()
    assert gaps[-1][0] < 1e-3


def test_a_ring_on_a_bearing(fitted_order):
    """A load that pulls it away from the bearing leaves a ring in its plane: it does not spin, and
    the bearing holds it as a clamp does."""
    gaps = []
    for n in FINE:
        angle = 2 * np.pi * np.arange(n) / n
        points = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
        shapes = []
        for clamp in (True, "tangent"):
            scene = rod_through(
                points,
                section([0, 0, 1], EA=1e4, EI1=1.0, EI2=2.0, GJ=0.8),
                rod={"closed": True},
                supports=[{**START, "clamp": clamp}],
                loads=[force(-0.3, 0.2, 0.0, at=np.pi * 0.75)],
            )
            values, _ = measured(scene, [np.pi, np.pi / 2], (*XYZ, "moment_1", "moment_2"))
            shapes.append(values.ravel())
        gaps.append([np.abs(shapes[0] - shapes[1]).max()])
    assert (orders(fitted_order, FINE, gaps) > 1.9).all()
    assert gaps[-1][0] < 1e-3


def test_frequencies_of_a_shaft_in_a_bearing(fitted_order):
    """It bends as a beam clamped at both ends and as a cantilever, each of half its length; its
    torsion does not know of the bearing."""
    clamped, free = 4.730040744862704, 1.875104068711961  # beta L
    bending = np.outer([clamped**2, free**2], np.sqrt([3.0, 1.0])).ravel() / 0.5**2
    torsion = np.pi * np.array([0.5, 1.5]) * np.sqrt(0.8 / 0.02)
    exact = np.sort(np.concatenate([bending, torsion]))[:4]
    strip = section([0, 1, 0], EA=1e8, EI1=3.0, EI2=1.0, GJ=0.8, rotary_inertia=0.02)
    errors = []
    for n in FINE:
        scene = straight_rod(n, strip, supports=[*CLAMPED, BEARING])
        scene["analysis"] = {"modes": {"count": 6}}
        found = 2 * np.pi * np.array(der.run(scene).summary["frequencies_hz"])
        errors.append([np.abs(found - each).min() / each for each in exact])
    assert (orders(fitted_order, FINE, errors) > 1.9).all()
    assert np.max(errors[-1]) < 1e-3


def test_bearings_alone_do_not_hold_a_shaft_against_spinning():
    supports = [{**START, "clamp": "tangent"}, BEARING]
    shaft = straight_rod(16, STRIP, supports=supports, loads=[moment(0.3, 0, 0)])
    with pytest.raises(der.NotConvergedError, match="spins freely about the tangent"):
        der.run(shaft)
    held = [*supports, {**END, "spring": {"rotational_stiffness": [0, 0, 2.0]}}]
    der.run({**shaft, "supports": held})


def test_what_a_bearing_refuses():
    bent = rod_through(
        [[0, 0, 0], [0.5, 0, 0], [1, 0, 0], [1, 0.5, 0], [1, 1, 0]],
        STRIP,
        supports=[*CLAMPED, BEARING],
    )
    with pytest.raises(der.DerError, match="is at a corner, where the rod has two tangents"):
        der.run(bent)
    turned = {**BEARING, "prescribe": {"rotation": {"axis": [0, 0, 1], "angle": 0.1}}}
    with pytest.raises(der.DerError, match="does not turn: write 'clamp: true'"):
        der.run(straight_rod(8, STRIP, supports=[*CLAMPED, turned]))


def test_a_planar_rod_in_a_bearing_is_not_tested_out_of_its_plane():
    rod = straight_rod(8, section(EA=1e6, EI=1.0, GJ=0.8), supports=[*CLAMPED, BEARING])
    result = der.run({**rod, "loads": [force(0, 1, 0)], "model": "planar"})
    assert "supports.1 lets rod 'rod' spin within it" in str(result.summary)
