"""``python -m der`` is the command ``der``."""

import sys

from der_command import main

sys.exit(main())
