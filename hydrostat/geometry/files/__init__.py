"""Shapes from and to files: drawings and pictures, surfaces, ready meshes."""
