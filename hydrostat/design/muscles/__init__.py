"""Muscle fibres in a body, and which of them bring it into a pose."""
