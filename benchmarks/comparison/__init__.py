"""Scenes that several codes simulate: cost against error.

`scene` holds what all scenes and codes share, `scenes` is the table of scenes. Each scene is a
folder: `problem.py` has its numbers, `code_*.py` one code each. What one code does alike in all
scenes is in `run_*.py`. `measure` runs them, `report` and `plot` show what came out. The program
is ``benchmarks/peers.py``.
"""
