"""Static equilibrium: one solve, loading paths for energies with a history, batches, and the reasons of a failure."""
