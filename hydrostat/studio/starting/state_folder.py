"""`state_folder`: where the studio keeps what it remembers between runs."""

import os
import sys
from pathlib import Path


def state_folder() -> Path:
    """The folder of this person's studio; it need not be there yet."""
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or str(Path.home() / "AppData" / "Local")
    else:
        base = os.environ.get("XDG_STATE_HOME") or str(Path.home() / ".local" / "state")
    return Path(base) / "hydrostat" / "studio"
