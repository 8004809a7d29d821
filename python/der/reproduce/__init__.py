"""The course report that the project began with: run anew, and compared number by number."""

from der.reproduce.reproducing import reproduce

__all__ = ["reproduce"]
