"""Memory of this process."""

import os
from pathlib import Path


def resident() -> int:
    """Return the bytes of memory that this process holds (Linux only)."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")
