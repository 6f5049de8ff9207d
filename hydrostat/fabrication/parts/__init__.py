"""The rigid parts of a robot: winches, stoppers, grommets, the base for motors outside the body."""
