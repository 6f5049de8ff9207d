"""hydrostat: from a shape to a working cable-driven soft robot."""
