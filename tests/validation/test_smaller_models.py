"""Quantities of space in the models that `auto` chooses where a scene in space needs no more.

The reference is `model: spatial` on the same scene: it has every quantity by itself.
"""

import der
import numpy as np
import pytest
from scenes import END, START

SIZES = (20, 40, 80)
STEPS = [1 / n for n in SIZES]
#: Of the sections of an arc in the plane: towards director 1, director 2, their opposites; round.
DIRECTORS = {
    "second": ([0, 0, 1], {"EI1": 3.0, "EI2": 1.0}),
    "minus second": ([0, 0, -1], {"EI1": 3.0, "EI2": 1.0}),
    "first": ([0, 1, 0], {"EI1": 1.0, "EI2": 3.0}),
    "minus first": ([0, -1, 0], {"EI1": 1.0, "EI2": 3.0}),
    "oblique": ([0, 0.6, -0.8], {"EI1": 1.0, "EI2": 1.0}),
}


def arc(n, director, stiffness, **more):
    """A flat arc on a clamp, bent by a force, a moment, a spring and an actuation."""
    angles = 0.8 * np.arange(n + 1) / n
    points = np.stack([np.sin(angles), 1 - np.cos(angles), 0 * angles], axis=1) / 0.8
    section = {"EA": 1e3, "GJ": 0.7, "mass_per_length": 1.0, "rotary_inertia": 1e-3} | stiffness
    rod = {
        "name": "rod",
        "points": points.tolist(),
        "cross_section": {"stiffness": section, "director": director},
    }
    return {
        "rods": [rod],
        "supports": [
            {**START, "clamp": True, "prescribe": {"rotation": {"axis": [0, 0, 1], "angle": 0.1}}},
            {"rod": "rod", "at": 0.4, "spring": {"stiffness": [3, 5, 7]}},
        ],
        "loads": [
            {"point_force": {**END, "force": [-0.4, 1.1, 0]}},
            {"moment": {"rod": "rod", "at": 0.7, "moment": [0, 0, 0.6]}},
        ],
        "analysis": "static",
        **more,
    }


def straight_in_space(n, **more):
    """A round rod that bends out of the plane and does not twist."""
    stiffness = {"EA": 1e3, "EI": 1.0, "GJ": 0.7, "mass_per_length": 1.0}
    section = {"stiffness": stiffness, "director": [0.2, 0.6, -0.7]}
    rod = {
        "name": "rod",
        "nodes": n + 1,
        "from": [0, 0, 0],
        "to": [1, 0, 0],
        "cross_section": section,
    }
    return {
        "rods": [rod],
        "supports": [{"rod": "rod", "at": 0.5, "clamp": True}],
        "loads": [
            {"point_force": {**END, "force": [-0.4, 1.1, 0]}},
            {"point_force": {**END, "force": [-0.2, 0.3, 1.8]}},
            {"point_force": {**START, "force": [0.2, 1.3, -0.8]}},
        ],
        "analysis": "static",
        **more,
    }


ALONG = {"position", "tangent", "bend", "edge", "section", "natural"}
#: Energies need no larger model, and with joints there is no smaller one.
KINDS = ALONG | {"velocity", "support", "actuation", "ring", "energy", "joint", "spring"}


def spatial_quantities(kinds):
    """Those of the spatial model, of these kinds, by name."""
    scene = {**arc(20, *DIRECTORS["second"]), "model": "spatial"}
    model = der.Model(der.Scenario.from_dict(scene))
    available = [q for q in der.quantities() if q.is_available(model)]
    assert {q.kind for q in available} == KINDS
    return [q.name for q in available if q.kind in kinds]


def probes_along(names):
    """Inside, beside the clamp and at the end, and the extremes of each."""
    probes = {}
    for name in names:
        along = {"rod": "rod", "quantity": name}
        for i, s in enumerate(("start", 0.25, 0.5, 0.9, "end")):
            probes[f"{name}-{i}"] = {**along, "at": s}
        for extreme in ("min", "max"):
            probes[f"{name}-{extreme}"] = {**along, "over": "rod", "reduce": extreme}
    return probes


def final(scene, probes, model):
    """The final values of the probes, and the model that the scene has got."""
    output = {"probes": probes} | ({"every": 0.1} if "time" in scene else {})
    result = der.run(der.Scenario.from_dict({**scene, "model": model, "output": output}))
    return {name: values[-1] for name, values in result.probes.items()}, result.model.name


def check_agreement(fitted_order, scene_of, probes, chosen):
    """Values of the two models differ by the order of the method."""
    off = {name: [] for name in probes}
    scale = dict.fromkeys(probes, 0.0)
    for n in SIZES:
        scene = scene_of(n)
        found, model = final(scene, probes, "auto")
        exact, _ = final(scene, probes, "spatial")
        assert model == chosen
        for name in probes:
            off[name].append(found[name] - exact[name])
            scale[name] = max(scale[name], abs(exact[name]))
    for name, errors in off.items():
        if max(map(abs, errors)) > 1e-7 * max(1.0, scale[name]):
            assert fitted_order(STEPS, errors) > 1.85, (name, errors)
            assert abs(errors[-1]) < 2e-3 * max(1.0, scale[name]), name


@pytest.mark.parametrize("director", DIRECTORS)
def test_a_flat_arc(fitted_order, director):
    """Curvatures and moments are towards the director that lies in the plane, with its sign."""
    names = spatial_quantities(ALONG)
    probes = probes_along(names)
    for q in spatial_quantities({"support"}):
        probes |= {f"{q}-{i}": {"support": i, "quantity": q} for i in (0, 1)}
    check_agreement(fitted_order, lambda n: arc(n, *DIRECTORS[director]), probes, "planar")


@pytest.mark.parametrize("director", ["second", "minus first"])
def test_actuations_of_a_flat_arc(fitted_order, director):
    """Towards the director in the plane; a round rod would take part in both."""
    first, second = (0, 0.5) if director == "second" else (-0.5, 0)
    parts = [
        {"name": "bend", "rod": "rod", "to": 0.6, "natural_curvature": [first, second]},
        {"name": "grow", "rod": "rod", "from": 0.5, "elongation": 0.02},
    ]
    names = spatial_quantities({"section", "natural"})
    probes = probes_along(names)
    for q in spatial_quantities({"actuation"}):
        if q != "actuation_torque":  # a twist is never flat
            name = "grow" if q == "actuation_force" else "bend"
            probes[q] = {"actuation": name, "quantity": q}

    def scene(n):
        return arc(n, *DIRECTORS[director], actuation=parts)

    check_agreement(fitted_order, scene, probes, "planar")


def test_a_flat_arc_that_moves(fitted_order):
    """The velocities, along z too, and the reactions."""
    time = {"duration": 0.2, "step": 0.002, "integrator": "implicit_midpoint"}
    probes = probes_along(spatial_quantities({"velocity"}))
    for q in spatial_quantities({"support"}):
        probes[q] = {"support": 0, "quantity": q}

    def scene(n):
        moving = arc(n, *DIRECTORS["second"], time=time)
        del moving["analysis"], moving["supports"][0]["prescribe"]
        moving["loads"][1]["moment"]["moment"] = [0, 0, 0]
        return moving

    check_agreement(fitted_order, scene, probes, "planar")


def test_a_flat_ring():
    """It has no writhe, and its sections go around it once with the tangent: no link."""
    angles = 2 * np.pi * np.arange(24) / 24
    points = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    scene = arc(4, *DIRECTORS["second"])
    scene["rods"][0] |= {"points": points.tolist(), "closed": True}
    scene["rods"][0]["cross_section"]["director"] = [0, 0, 1]
    scene["supports"] = [{**START, "clamp": True}]
    scene["loads"] = [{"point_force": {"rod": "rod", "at": "middle", "force": [0.3, 0.2, 0]}}]
    names = spatial_quantities({"ring"})
    assert set(names) == {"writhe", "link"}
    probes = {name: {"rod": "rod", "quantity": name} for name in names}
    found, model = final(scene, probes, "auto")
    exact, _ = final(scene, probes, "spatial")
    assert model == "planar"
    assert found == {"writhe": 0.0, "link": 0.0}
    assert exact == pytest.approx(found, abs=1e-9)


@pytest.mark.parametrize("turned", [False, True])
def test_a_rod_that_does_not_twist(fitted_order, turned):
    """Its directors go along it, to both sides, from the clamp that holds its section."""
    names = spatial_quantities(ALONG)
    probes = probes_along(names)
    for q in spatial_quantities({"support"}):
        probes[q] = {"support": 0, "quantity": q}

    def scene(n):
        bent = straight_in_space(n)
        if turned:
            turn = {"axis": [1, 2, 0.5], "angle": 0.7}
            bent["supports"][0] |= {"prescribe": {"rotation": turn}}
        return bent

    check_agreement(fitted_order, scene, probes, "spatial_bend")


@pytest.mark.parametrize("name", ["curvature_1", "curvature_2", "moment_1", "moment_2"])
def test_sections_that_nothing_holds_have_no_directors(name):
    """They spin with the motion; only the spatial model follows them."""
    scene = straight_in_space(10)
    scene["loads"] = scene["loads"][2:]
    scene["supports"] = [{**END, "clamp": "tangent"}, {**START, "spring": {"stiffness": [1, 1, 1]}}]
    probes = {"p": {"rod": "rod", "at": 0.3, "quantity": name}}
    with pytest.raises(der.SceneError, match="no clamp holds the section of rod 'rod'"):
        final(scene, probes, "auto")
    result = der.run(der.Scenario.from_dict(scene))
    assert result.model.name == "spatial_bend"
    with pytest.raises(der.DerError, match="no clamp holds the section of rod 'rod'"):
        result.along("rod", name)


def test_along_a_flat_rod():
    """Python reads along the rod what a probe reads at one place."""
    result = der.run(der.Scenario.from_dict(arc(20, *DIRECTORS["minus second"])))
    assert result.model.name == "planar"
    _, curvature = result.along("rod", "curvature")
    _, toward_second = result.along("rod", "curvature_2")
    assert np.array_equal(np.abs(toward_second), curvature)
    assert (toward_second > 0).any()
    s, z = result.along("rod", "z")
    assert len(s) == 21
    assert not z.any()


def cantilever(push):
    """Bent along y by 0.01 N, and along z by `push` [N]."""
    rod = {
        "name": "rod",
        "nodes": 21,
        "from": [0, 0, 0],
        "to": [1, 0, 0],
        "cross_section": {"circle": {"radius": 0.01}},
        "material": {"youngs_modulus": 1e7, "poissons_ratio": 0.4, "density": 1000},
    }
    along = {"rod": "rod", "at": 0.1}
    probes = {
        "z": {**END, "quantity": "z"},
        "about_y": {"support": 0, "quantity": "reaction_moment_y"},
        "about_z": {"support": 0, "quantity": "reaction_moment_z"},
        "k1": {**along, "quantity": "curvature_1"},
        "k2": {**along, "quantity": "curvature_2"},
        "torque": {**along, "quantity": "torque"},
    }
    return {
        "rods": [rod],
        "supports": [{**START, "clamp": True}],
        "loads": [{"name": "push", "point_force": {**END, "force": [0, 0.01, push]}}],
        "analysis": "static",
        "output": {"probes": probes},
    }


def test_a_sweep_through_a_flat_scene():
    """In it the values are those between its neighbours, and every program runs it."""
    pushes = np.array([-1e-4, 0.0, 1e-4])
    table = der.sweep(cantilever(0.5), {"loads.push.point_force.force.2": pushes}).to_numpy()
    assert table["status"].tolist() == ["static_converged"] * 3
    names = list(cantilever(0.0)["output"]["probes"])
    values = {name: table[f"{name}.final"] for name in names}
    for name in ("z", "about_y", "k1"):
        assert values[name][1] == 0.0
        assert values[name][0] == pytest.approx(-values[name][2], rel=1e-6)
        assert abs(values[name][0]) > 1e-6
    for name in ("about_z", "k2"):
        assert values[name][1] == pytest.approx(values[name].mean(), rel=1e-6)
    assert values["about_z"][1] < 0.0
    assert values["k2"][1] < 0.0  # director 1 is along z, so that 2 is along -y


def bent_to_both_sides():
    """A cantilever with a moment that changes its sign; loads.0 pushes."""
    scene = straight_in_space(20, supports=[{**START, "clamp": True}])
    pull, push = scene["loads"][:2]
    push["point_force"] |= {"at": "middle", "force": [0, -2.5, 0]}
    return {**scene, "loads": [push, pull]}


def driven_arc():
    grow = {"name": "grow", "rod": "rod", "from": 0.5, "elongation": 0.02}
    bend = {"name": "bend", "rod": "rod", "to": 0.6, "natural_curvature": [0, 2.5]}
    return arc(20, *DIRECTORS["second"], actuation=[bend, grow])


def moving_arc():
    time = {"duration": 0.1, "step": 0.002, "integrator": "implicit_midpoint"}
    scene = arc(20, *DIRECTORS["minus first"], time=time)
    del scene["analysis"], scene["supports"][0]["prescribe"]
    return {**scene, "loads": scene["loads"][:1]}


def ring():
    angles = 2 * np.pi * np.arange(24) / 24
    points = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    pull = {"point_force": {"rod": "rod", "at": "middle", "force": [0.3, 0.2, 0]}}
    scene = arc(4, *DIRECTORS["second"], supports=[{**START, "clamp": True}], loads=[pull])
    scene["rods"][0] |= {"points": points.tolist(), "closed": True}
    scene["rods"][0]["cross_section"]["director"] = [0, 0, 1]
    return scene


def probes_of_everything(scene):
    """Of every quantity that there is, whether the scene has it or not."""
    probes = {}
    for quantity in der.quantities():
        name, of = quantity.name, {"quantity": quantity.name}
        if quantity.kind == "energy":
            probes[name] = of
        elif quantity.kind == "support":
            probes |= {f"{name}-{i}": {**of, "support": i} for i in range(len(scene["supports"]))}
        elif quantity.kind == "actuation":
            for one in scene.get("actuation", []):
                probes[f"{name}-{one['name']}"] = {**of, "actuation": one["name"]}
        elif quantity.kind == "ring":
            probes[name] = {**of, "rod": "rod"}
        else:
            probes |= probes_along([name])
    return probes


def answered(scene, probes):
    """Those probes that are not refused."""
    try:
        der.Scenario.from_dict({**scene, "output": {**scene.get("output", {}), "probes": probes}})
    except der.SceneError as error:
        # The last of many says how many more there are.
        paths = [d.path.split(".") for d in error.diagnostics]
        refused = {path[2] for path in paths if path[:2] == ["output", "probes"]}
        if not refused:
            raise
        return answered(scene, {p: v for p, v in probes.items() if p not in refused})
    return probes


@pytest.mark.parametrize("flat", [bent_to_both_sides, driven_arc, moving_arc, ring])
def test_no_quantity_jumps_in_a_sweep_through_a_flat_scene(flat):
    """The components of a scene's vectors tell what a probe means, not the model for its values."""
    readings, models = [], []
    for push in (-1e-5, 0.0, 1e-5):
        scene = flat()
        scene["loads"][0]["point_force"]["force"][2] = push
        scene["output"] = {"every": 0.1} if "time" in scene else {}
        found, model = final(scene, answered(scene, probes_of_everything(scene)), "auto")
        readings.append(found)
        models.append(model)
    below, here, above = readings
    assert models[1] == "planar"
    assert models[0] == models[2] != "planar"
    assert set(here) == set(below) == set(above)
    assert len(here) > 100
    for name, value in here.items():
        between = 0.5 * (below[name] + above[name])
        # Smaller than what 1e-5 N does and the error of the mesh, larger than no change of sign.
        assert value == pytest.approx(between, abs=2e-4 * max(1.0, abs(between))), name
    assert here["curvature-1"] > 0.01


@pytest.mark.parametrize(
    ("quantity", "instead"),
    [("slope", "'tx', 'ty' and 'tz'"), ("natural_curvature", "'natural_curvature_1'")],
)
def test_a_flat_scene_lacks_what_its_neighbours_lack(quantity, instead):
    """Values of a plane alone have to be asked for with the model."""
    scene = bent_to_both_sides()
    probes = {"p": {**END, "quantity": quantity}}
    lacks = f"a scene of three components has no '{quantity}', flat as it is: .*take {instead}"
    with pytest.raises(der.SceneError, match=lacks + ".*; or write 'model: planar'"):
        final(scene, probes, "auto")
    assert final(scene, probes, "planar")[1] == "planar"
    result = der.run(der.Scenario.from_dict(scene))
    assert result.model.name == "planar"
    with pytest.raises(der.DerError, match=lacks):
        result.along("rod", quantity)


@pytest.mark.parametrize("sections", [{"EI": 1.0}, {"EI1": 2.7, "EI2": 1.0}])
def test_modes_of_a_flat_scene_leave_its_plane(sections):
    """As those of its neighbours. Cantilever: omega = beta^2 sqrt(EI/mu) to either side."""
    beta = np.array([1.875104068711961, 4.694091132974175, 7.854757438237613])
    stiff = np.sqrt(list(sections.values()) * 2)[:2]
    section = {"EA": 1e8, "GJ": 1e3, "mass_per_length": 1.0, **sections}
    rod = {"name": "rod", "nodes": 41, "from": [0, 0, 0], "to": [1, 0, 0]}
    scene = {
        "rods": [{**rod, "cross_section": {"stiffness": section}}],
        "supports": [{**START, "clamp": True}],
        "analysis": {"modes": {"count": 6}},
    }

    def frequencies(scene):
        result = der.run(der.Scenario.from_dict(scene))
        return 2 * np.pi * np.array(result.summary["frequencies_hz"]), result.model

    found, model = frequencies(scene)
    assert found == pytest.approx(np.sort(np.outer(beta**2, stiff).ravel()), rel=2e-3)
    assert "modes of a scene of three components are those in space" in model.reason
    # Seen from next to the plane.
    scene["loads"] = [{"point_force": {**END, "force": [0, 0, 1e-9]}}]
    beside, other = frequencies(scene)
    assert other.name == model.name == ("spatial_bend" if "EI" in sections else "spatial")
    assert beside == pytest.approx(found, rel=1e-6)
    del scene["loads"]
    in_plane, model = frequencies({**scene, "model": "planar"})
    assert model.name == "planar"
    assert in_plane[:3] == pytest.approx(beta**2 * stiff[-1], rel=2e-3)


def test_modes_of_a_flat_ring_twist_it():
    """Though it is straight without stress, and round."""
    scene = ring()
    scene["rods"][0]["natural_curvature"] = [0, 0]
    section = {"EA": 1e3, "EI": 1.0, "GJ": 0.7, "mass_per_length": 1.0}
    scene["rods"][0]["cross_section"] = {"stiffness": section}
    scene["supports"] = [{**START, "clamp": "tangent"}]
    scene |= {"loads": [], "analysis": "modes"}
    assert der.Model(der.Scenario.from_dict(scene)).name == "spatial"
    with pytest.raises(der.SceneError, match="its writhe twists it"):
        der.Scenario.from_dict({**scene, "model": "spatial_bend"})


def test_error_bars_and_arrays_of_a_flat_scene():
    verification = der.verify(cantilever(0.0))
    assert verification["z"].value == 0.0
    assert verification["z"].error_bar < 1e-11
    simulation = der.Simulation(der.Scenario.from_dict(cantilever(0.0)))
    simulation.equilibrium()
    assert simulation.probes["about_y"] == 0.0
    assert simulation.probes["about_z"] == simulation.reactions()[0].moment


def test_a_batch_through_a_flat_scene():
    """Its members share one structure: the message names the model that all of them can have."""
    vary = {"loads.push.point_force.force.2": [1e-4, 0.0, -1e-4]}
    with pytest.raises(der.DerError, match="write 'model: spatial_bend', which can have both"):
        der.Batch(cantilever(0.5), 3, vary=vary)
    scene = cantilever(0.5)
    for name in ("k1", "k2", "torque"):  # a model that is asked for has its own quantities
        del scene["output"]["probes"][name]
    batch = der.Batch({**scene, "model": "spatial_bend"}, 3, vary=vary)
    batch.equilibrium()
    assert batch.probes["z"][1] == pytest.approx(0.0, abs=1e-12)
    assert batch.probes["z"][0] == pytest.approx(-batch.probes["z"][2], rel=1e-6)
