"""`checked_parts`: pins and markers that were checked on a body."""

from hydrostat.robot.body import Body


def checked_parts(body: Body) -> dict[str, object]:
    """Return the pins and markers of robots that were checked on this very body: other networks do not change them."""
    return body.__dict__.setdefault("_checked_parts", {})
