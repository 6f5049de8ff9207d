"""`page_pictures`: pages of a PDF as pictures, to be looked at before it is downloaded."""

from pathlib import Path
from tempfile import TemporaryDirectory

DOTS = 110.0
"""To the inch: fine enough to be read where a page is as wide as a window."""

MOST_PAGES = 12


def page_pictures(pdf: bytes) -> tuple[bytes, ...]:
    """Each page as PNG; none if the typesetter at hand is too old to read PDF."""
    import typst

    with TemporaryDirectory() as folder:
        sheet, source = Path(folder) / "sheet.pdf", Path(folder) / "pages.typ"
        sheet.write_bytes(pdf)
        pages = []
        for number in range(1, MOST_PAGES + 1):
            source.write_text(_PAGE.format(number=number), encoding="utf-8")
            try:
                pages.append(typst.compile(source, format="png", ppi=DOTS))
            except (RuntimeError, typst.TypstError):  # the sheet has no such page
                break
    return tuple(pages)


_PAGE = '#set page(width: auto, height: auto, margin: 0pt)\n#image("sheet.pdf", page: {number})\n'
