"""`Point`: coordinates in a record."""

Point = tuple[float, ...]
"""Coordinates [m] in the rest pose, two or three."""
