"""A panel for each stage."""
