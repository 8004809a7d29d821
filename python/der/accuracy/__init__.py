"""How large errors are: verifying a scene, and studying cost against error."""

from der.accuracy.error_bars import ErrorEstimate
from der.accuracy.studier import study
from der.accuracy.study_result import Study
from der.accuracy.study_row import StudyRow
from der.accuracy.verification import Verification
from der.accuracy.verified_value import VerifiedValue
from der.accuracy.verifier import verify

__all__ = [
    "ErrorEstimate",
    "Study",
    "StudyRow",
    "Verification",
    "VerifiedValue",
    "study",
    "verify",
]
