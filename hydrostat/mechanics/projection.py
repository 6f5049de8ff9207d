"""`Projection`: the shares of the Hessian's negative part that Newton takes out where it is not definite."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Projection:
    """Shares, 0 to 1, of the negative part of the Hessian that are taken out.

    Near a buckling load the full Hessian is indefinite by a hair only. There the projected one is far too stiff: it
    drops the whole effect of compression, and Newton creeps for hundreds of steps. So a share is taken out, which falls
    from step to step as long as it suffices. Contact comes first, and whole: the negative eigenvalues of its pairs are
    few, and a smaller share seldom suffices.

    Attributes:
        early: share of energies that project first, such as contact.
        late: share of the others.
        raised: True if smaller shares did not suffice for the last step; contact's share then stays for one more.
    """

    early: float = 0.0
    late: float = 0.0
    raised: bool = False

    @property
    def any(self) -> bool:
        """True if something is taken out."""
        return self.early > 0.0 or self.late > 0.0

    @property
    def whole(self) -> bool:
        """True if nothing negative is left."""
        return self.late == 1.0

    def with_smaller_shares(self, *, projects_first: bool, left: float = 0.0) -> "Projection":
        """Return smaller shares, to begin the next step with.

        Of a first Hessian `left` is the residual, as a share of the largest applied force. Far from equilibrium, as
        after the prediction, it is seldom definite with small shares, and a step with all of them is as good.
        """
        if left > _FAR_RESIDUAL and not projects_first:
            return Projection(late=1.0)
        if self.late > _MIN_NEGATIVE_SHARE:
            return Projection(float(projects_first), self.late / 16)
        return Projection(self.early if self.raised and projects_first else 0.0)

    def with_larger_shares(self, *, projects_first: bool, negative: int = 0) -> "Projection":
        """Return larger shares, where these left so many negative eigenvalues."""
        if projects_first and negative >= _MANY_NEGATIVE and not self.late:
            return Projection(1.0, 1.0, raised=True)
        if projects_first and self.early < 1.0 and not self.late:
            return Projection(1.0, raised=True)
        if projects_first:
            return Projection(1.0, 1.0 if self.late else 1 / 8, raised=True)
        return Projection(0.0, min(16 * self.late, 1.0) or 1.0)


_MANY_NEGATIVE = 7
"""From this number of negative eigenvalues on, contact's share alone or 1/8 of the others' seldom suffice."""

_FAR_RESIDUAL = 0.3
"""With a larger residual all that is negative is taken out of a first Hessian."""

_MIN_NEGATIVE_SHARE = 1 / 32
"""Below this share of what is negative, the full Hessian is tried."""
