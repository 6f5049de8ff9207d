"""Solids in millimeters: what is printed, how it is put together, and the files that carry it."""
