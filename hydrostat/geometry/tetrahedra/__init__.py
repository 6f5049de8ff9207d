"""Tetrahedra from a closed surface."""
