"""Contractions by hand and in time (R58)."""
