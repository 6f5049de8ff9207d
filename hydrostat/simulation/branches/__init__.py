"""Several equilibria at the same contractions: branches, snap-through, and what friction leaves between them."""
