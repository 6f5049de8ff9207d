"""Several equilibria at the same contractions: branches, snap-through, friction hysteresis."""
