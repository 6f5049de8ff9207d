"""Motion in time: the integrator, its records and their files."""
