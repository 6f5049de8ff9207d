"""Cables priced by the adjoint field of the pose error, and moved to where it is least."""
