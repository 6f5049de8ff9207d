"""`CableSide`: side of a stuffed flat robot on which its cables run: front, back, both or the middle."""

from enum import StrEnum


class CableSide(StrEnum):
    """Side of a flat robot on which its cables run once it is stuffed."""

    FRONT = "front"  # sewn on the panel that is looked at
    BACK = "back"  # on the other one
    PAIRS = "pairs"  # each twice, on both panels, pulled together
    MIDDLE = "middle"  # through the filling, half way between

    @property
    def words(self) -> str:
        """Such as "on both faces, in pairs"."""
        return _WORDS[self]

    @property
    def sides(self) -> tuple[str, ...]:
        """Panels on which cables are sewn, by their names; none for the middle."""
        return _SIDES[self]

    @property
    def flat(self) -> bool:
        """True if cables there keep a body in its plane, up to fractions of a millimeter (decision 0029)."""
        return self in (CableSide.PAIRS, CableSide.MIDDLE)


_WORDS = {
    CableSide.FRONT: "on the front",
    CableSide.BACK: "on the back",
    CableSide.PAIRS: "on both faces, in pairs",
    CableSide.MIDDLE: "in the middle",
}
_SIDES = {
    CableSide.FRONT: ("front",),
    CableSide.BACK: ("back",),
    CableSide.PAIRS: ("front", "back"),
    CableSide.MIDDLE: (),
}
