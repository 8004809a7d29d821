"""The scene `helical_buckling` against `references/helical_buckling.py`."""

import der
import numpy as np


def test_a_twisted_rod_buckles_into_the_localised_helix(scene, spatial_reference, fitted_order):
    """At rest: torque, tension and the shape of the boundary value problem of the finite rod, with
    order 2; the envelope is the tanh^2 of the infinite one."""

    def exact(name):
        return spatial_reference("helical_buckling", name)

    wanted = [exact(f"EA10000.{name}") for name in ("torque", "tension", "angle", "s0.y")]
    errors = []
    meshes = [200, 400]
    for edges in meshes:
        result = der.run(scene("helical_buckling").with_(**{"rods.rod.nodes": edges + 1}))
        line = result.positions[-1]
        middle = edges // 2
        along = line[2:] - line[:-2]
        angles = np.arccos(along[:, 0] / np.linalg.norm(along, axis=1))  # of inner nodes
        values = [result.probes[name][-1] for name in ("torque", "tension")]
        values += [angles[middle - 1], np.hypot(*line[middle, 1:])]
        errors.append(np.abs(np.array(values) - wanted))
    orders = [fitted_order(1 / np.array(meshes), column) for column in np.transpose(errors)]
    assert min(orders) > 1.9
    assert (errors[-1] < [2e-4, 3e-3, 7e-3, 3e-3]).all()

    s = np.linspace(-50, 50, edges + 1)[1:-1]
    cosine = np.cos(exact("infinite.angle"))
    envelope = cosine + (1 - cosine) * np.tanh(s / exact("infinite.width")) ** 2
    assert np.abs(np.cos(angles) - envelope).max() < 0.01
    # The envelope is that of the middle alone; towards the clamps the rod is straight.
    assert angles[np.abs(s) > 25].max() < 0.02
