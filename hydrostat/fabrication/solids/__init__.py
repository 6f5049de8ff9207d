"""Solids in millimetres: what is printed, how it is put together, and the files that carry it."""
