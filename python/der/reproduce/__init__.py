"""The course report that the project started from: run again, and compared number by number."""

from der.reproduce.reproducing import reproduce

__all__ = ["reproduce"]
