"""Poses in time."""
