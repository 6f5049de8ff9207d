"""Text of finished pages, read back by pypdf, once for each file."""

import io
from functools import cache

from pypdf import PdfReader


@cache
def read_words(content: bytes) -> str:
    """All text of a PDF with single spaces."""
    pages = PdfReader(io.BytesIO(content)).pages
    return " ".join("\n".join(page.extract_text() for page in pages).split())
