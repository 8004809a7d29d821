"""Hard cases: what der does where numbers, meshes, steps and supports are extreme."""

from . import meshes, motions, rests, sizes, spatial, steps, stiffness, supports
from .case import CASES, Case, Row, complaints, play
from .setting import MODELS, Setting

__all__ = ["CASES", "MODELS", "Case", "Row", "Setting", "complaints", "play"]
_ENTER_CASES = (stiffness, meshes, steps, motions, rests, sizes, supports, spatial)
