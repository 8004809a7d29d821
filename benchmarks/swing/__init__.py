"""One scene, the swing, in several codes: cost against error.

A soft rod, clamped horizontally at x = 0, swings down under its weight for a second. `problem`
holds its numbers, `code_*.py` one code each, `measure` runs them, `report` and `plot` show what
came out. The program is ``benchmarks/peers.py``.
"""
