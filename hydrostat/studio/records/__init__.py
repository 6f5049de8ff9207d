"""Records that the studio keeps with a robot: plain and frozen."""
