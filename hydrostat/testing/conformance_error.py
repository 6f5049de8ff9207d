"""`ConformanceError`: a part breaks its contract."""


class ConformanceError(AssertionError):
    """A conformance check, such as "gradient", failed: the entry that is furthest off, and how far, as a fraction."""

    def __init__(self, check: str, message: str, *, index: tuple[int, ...] = (), relative_error: float = 0.0) -> None:
        where = f" at {list(index)}" if index else ""
        off = f" (relative error {relative_error:.2g})" if relative_error else ""
        super().__init__(f"{check}{where}: {message}{off}")
        self.check, self.index, self.relative_error = check, index, relative_error
