"""`Download`: a file to take home."""

from dataclasses import dataclass, field


@dataclass(frozen=True, kw_only=True)
class Download:
    """A file in memory; it is written nowhere until a person downloads it.

    Attributes:
        name: of the file.
        content: of it.
        title: what it is, as a person would say it.
    """

    name: str
    content: bytes = field(repr=False)
    title: str = ""

    @property
    def media_type(self) -> str:
        """As browsers name its kind."""
        return MEDIA_TYPES.get(self.name.rpartition(".")[2], "application/octet-stream")

    @property
    def size(self) -> str:
        """In words, such as "1.4 MB"."""
        count = len(self.content)
        return f"{count / 1e6:.1f} MB" if count >= 100_000 else f"{max(count / 1e3, 0.1):.3g} kB"


MEDIA_TYPES = {"zip": "application/zip", "png": "image/png", "svg": "image/svg+xml", "html": "text/html"}
