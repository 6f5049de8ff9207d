"""`Residuals`: predicted less measured places, lengths and forces as one vector."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Vector
from hydrostat.identification.marker_predictor import MarkerPrediction
from hydrostat.identification.measurements import Measurements


@dataclass(frozen=True, kw_only=True, eq=False)
class Residuals:
    """Predicted less measured quantities: coordinates, then distances of pairs [m], then forces [N].

    Attributes:
        errors: differences of all that was measured; NaN in rows without an equilibrium.
        jacobian: derivatives by the coordinates of the fit; 0 where there is no equilibrium.
        is_force: True for forces.
        rows: row of each.
        distances: distance of each predicted from its measured marker, then errors of the lengths [m].
    """

    errors: Vector
    jacobian: Float[np.ndarray, "errors parameters"]
    is_force: Bool[np.ndarray, " errors"]
    rows: Int[np.ndarray, " errors"]
    distances: Vector

    @classmethod
    def of(cls, found: MarkerPrediction, measured: Measurements) -> "Residuals":
        """Residuals of a prediction with its Jacobian."""
        assert found.jacobian is not None
        assert found.force_jacobian is not None
        lengths, by_length = distances(found, measured)
        parts = [
            (found.places, found.jacobian, measured.places),
            (lengths, by_length, measured.known_lengths),
            (found.forces, found.force_jacobian, measured.known_forces),
        ]
        errors, jacobians, rows = [], [], []
        for predicted, jacobian, seen in parts:
            known = np.isfinite(seen)
            errors.append((predicted - seen)[known])
            jacobians.append(jacobian[known])
            rows.append(np.nonzero(known)[0])
        is_force = np.arange(sum(map(len, errors))) >= sum(map(len, errors[:2]))
        away = np.linalg.norm(found.places - measured.places, axis=2).ravel()
        return cls(
            errors=np.concatenate(errors),
            jacobian=np.concatenate(jacobians),
            is_force=is_force,
            rows=np.concatenate(rows),
            distances=np.concatenate([away, errors[1]]),
        )


def distances(found: MarkerPrediction, measured: Measurements) -> tuple[np.ndarray, np.ndarray]:
    """Predicted distances of the pairs [m], (rows, pairs), and their Jacobian, (rows, pairs, parameters)."""
    assert found.jacobian is not None
    one, other = (np.array([pair[end] for pair in measured.pairs], dtype=int) for end in (0, 1))
    away = found.places[:, one] - found.places[:, other]
    lengths = np.linalg.norm(away, axis=2)
    along = away / np.maximum(lengths, np.finfo(float).tiny)[:, :, None]
    jacobian = np.einsum("rpd,rpdk->rpk", along, found.jacobian[:, one] - found.jacobian[:, other])
    return lengths, np.where(np.isfinite(lengths)[:, :, None], jacobian, 0.0)
