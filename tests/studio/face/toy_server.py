"""`Server`: a studio that runs as a program of its own."""

from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit


@dataclass(frozen=True)
class Server:
    """A program that serves the studio.

    Attributes:
        address: that it printed.
        pid: of the process.
    """

    address: str
    pid: int

    @property
    def port(self) -> int:
        """That it listens at."""
        return urlsplit(self.address).port or 0

    @property
    def token(self) -> str:
        """That it printed."""
        return urlsplit(self.address).query.removeprefix("token=")

    @property
    def memory(self) -> int:
        """What it takes [bytes]; 0 where the system does not tell."""
        told = Path(f"/proc/{self.pid}/statm")
        return 4096 * int(told.read_text().split()[1]) if told.exists() else 0
