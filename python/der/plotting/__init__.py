"""Pictures of results: one style, shapes drawn to scale, quantities with their units."""

from der.plotting.loads import draw_loads
from der.plotting.overview import plot, plot_states
from der.plotting.probes import draw_probe
from der.plotting.shapes import draw_shapes, pick_frames
from der.plotting.style import PALETTE, style, time_colours
from der.plotting.supports import draw_springs, draw_supports

__all__ = [
    "PALETTE",
    "draw_loads",
    "draw_probe",
    "draw_shapes",
    "draw_springs",
    "draw_supports",
    "pick_frames",
    "plot",
    "plot_states",
    "style",
    "time_colours",
]
