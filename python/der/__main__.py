"""``python -m der`` is the command ``der``."""

import sys

from der.cli import main

sys.exit(main())
