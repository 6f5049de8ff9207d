"""Pictures in commands: matplotlib without what only its own manual needs."""

import sys
from contextlib import suppress


def load_matplotlib() -> None:
    """Load matplotlib without writing the texts of its setters, which takes a third of the time.

    Classes describe the keywords of their `set` for `help()` as they are made; no command shows that.
    """
    if "matplotlib.artist" in sys.modules:
        return
    from matplotlib.artist import Artist

    name = "_update_set_signature_and_docstring"
    describe = vars(Artist).get(name)
    if describe is None:  # another version, which does otherwise
        return
    setattr(Artist, name, classmethod(lambda _: None))
    try:
        with suppress(ImportError):
            import matplotlib.figure  # noqa: F401
    finally:
        setattr(Artist, name, describe)
