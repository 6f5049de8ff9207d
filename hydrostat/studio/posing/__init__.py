"""Poses by hand: as if full of muscles, or by the robot's own cables."""
