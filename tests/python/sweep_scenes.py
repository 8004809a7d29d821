"""The scenes that tests of sweeps vary, and their rows for comparison bit by bit."""

FORCE = "loads.0.point_force.force.1"
STIFFNESS = "rods.arm.cross_section.stiffness.EI"

#: A strip loaded in its stiff plane, out of which it buckles sideways; at -1 it does not.
STRIP = {
    "rods": [
        {
            "name": "strip",
            "nodes": 11,
            "from": [0, 0],
            "to": [1, 0],
            "cross_section": {
                "stiffness": {"EA": 1e6, "EI1": 1, "EI2": 100, "GJ": 1, "mass_per_length": 1}
            },
        }
    ],
    "supports": [{"rod": "strip", "at": "start", "clamp": True}],
    "loads": [{"point_force": {"rod": "strip", "at": "end", "force": [0, -20]}}],
    "output": {"probes": {"tip_y": {"rod": "strip", "at": "end", "quantity": "y"}}},
}


def cantilever(nodes=11):
    """A clamped rod of length 1 and EI = 1 under a transverse force at its tip."""
    return {
        "title": "Cantilever",
        "rods": [
            {
                "name": "arm",
                "nodes": nodes,
                "from": [0, 0],
                "to": [1, 0],
                "cross_section": {"stiffness": {"EA": 1e6, "EI": 1.0, "mass_per_length": 0.1}},
            }
        ],
        "supports": [{"rod": "arm", "at": "start", "clamp": True}],
        "loads": [{"point_force": {"rod": "arm", "at": "end", "force": [0, -1]}}],
        "analysis": "static",
        "output": {"probes": {"tip_y": {"rod": "arm", "at": "end", "quantity": "y"}}},
    }


def of_each_kind():
    """Return a cantilever for each kind of run, by name; all take any positive STIFFNESS."""
    over_time, buckling = cantilever(), cantilever()
    del over_time["analysis"]
    over_time["time"] = {"duration": 0.1, "step": 0.002, "integrator": "implicit_midpoint"}
    buckling["analysis"] = {"buckling": {"count": 2}}
    buckling["loads"][0]["point_force"]["force"] = [-1, 0]
    return {
        "static": cantilever(),
        "over time": over_time,
        "modes": cantilever() | {"analysis": {"modes": {"count": 2}}},
        "buckling": buckling,
        "path": cantilever() | {"analysis": {"continuation": {}}},
    }


def bits(sweep):
    """Return the rows without their run times, floats as exact texts."""
    return [
        {name: repr(value) for name, value in row.items() if name != "seconds"}
        for row in sweep.rows
    ]
