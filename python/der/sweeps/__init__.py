"""Sweeps: one scene with many values of its parameters."""

from der.sweeps.sweep_result import Sweep, load_sweep
from der.sweeps.sweeper import sweep

__all__ = ["Sweep", "load_sweep", "sweep"]
