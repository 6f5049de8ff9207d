"""`Recent`: folders of robots that were opened or saved lately."""

import json
from contextlib import suppress
from pathlib import Path

from hydrostat.errors import HydrostatError
from hydrostat.robot import replace_file

MOST = 12
"""So many are remembered."""


class Recent:
    """A short list in a file."""

    def __init__(self, file: Path | None) -> None:
        """Remember in a file; None: nowhere."""
        self._file = file

    def folders(self) -> list[Path]:
        """Folders that still hold a robot, the latest first."""
        return [folder for folder in self._read() if (folder / "robot.toml").is_file()]

    def add(self, folder: Path) -> None:
        """Put a folder first; that it cannot be remembered is no reason to stop."""
        if self._file is None:
            return
        folder = folder.resolve()
        folders = [folder, *(other for other in self._read() if other != folder)][:MOST]
        with suppress(OSError, HydrostatError):
            self._file.parent.mkdir(parents=True, exist_ok=True)
            replace_file(self._file, json.dumps([str(folder) for folder in folders]).encode())

    def _read(self) -> list[Path]:
        if self._file is None:
            return []
        with suppress(OSError, ValueError):
            known = json.loads(self._file.read_text(encoding="utf-8"))
            if isinstance(known, list):
                return [Path(path) for path in known if isinstance(path, str)][:MOST]
        return []
