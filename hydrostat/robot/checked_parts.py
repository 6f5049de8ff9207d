"""`checked_parts`: pins and markers that were checked on a body."""

from weakref import finalize

from hydrostat.robot.body import Body

_CHECKED: dict[int, dict[str, object]] = {}
"""By the identity of bodies that live: equal bodies may have other meshes."""


def checked_parts(body: Body) -> dict[str, object]:
    """Return the pins and markers that were last checked on this very body: other networks do not change them.

    They are kept here, not in the body: pickles of a body hold the body alone.
    """
    if id(body) not in _CHECKED:
        _CHECKED[id(body)] = {}
        finalize(body, _CHECKED.pop, id(body), None).atexit = False
    return _CHECKED[id(body)]
