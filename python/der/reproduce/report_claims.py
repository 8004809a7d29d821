"""The numbers of the course report, the only ones here that are typed in."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal


@dataclass(frozen=True)
class Claim:
    """A number as it is printed.

    Attributes
    ----------
    text
        Its digits.
    unit
        Its SI unit.
    """

    text: str
    unit: str

    @property
    def value(self) -> float:
        """The number."""
        return float(self.text)

    @property
    def half_digit(self) -> float:
        """Half a unit of its last digit: what rounding may have taken."""
        exponent = Decimal(self.text).as_tuple().exponent
        assert isinstance(exponent, int)
        return 0.5 * 10.0**exponent

    def rounded(self, value: float) -> str:
        """Return a value with as many decimals."""
        exponent = Decimal(self.text).as_tuple().exponent
        assert isinstance(exponent, int)
        return f"{value:.{max(-exponent, 0)}f}"

    def is_met_by(self, value: float) -> bool:
        """Tell whether a value rounds to it."""
        return abs(value - self.value) <= self.half_digit * (1.0 + 1e-9)


TERMINAL_SPEED_3 = Claim("0.005966", "m/s")
TERMINAL_SPEED_21 = Claim("0.0068", "m/s")
EXPLICIT_SECONDS = Claim("3600", "s")
IMPLICIT_SECONDS = Claim("60", "s")
UNSTABLE_SECONDS = Claim("300", "s")
STABLE_STEP = Claim("0.00001", "s")
UNSTABLE_STEP = Claim("0.0001", "s")
DEFLECTION_2_KN = Claim("0.037", "m")
LINEAR_DEFLECTION_2_KN = Claim("0.038", "m")
DEFLECTION_20_KN = Claim("0.23", "m")
LINEAR_DEFLECTION_20_KN = Claim("0.38", "m")
