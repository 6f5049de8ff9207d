"""Triangles from an outline."""
