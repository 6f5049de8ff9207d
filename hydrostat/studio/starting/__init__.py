"""Beginnings of work: the gallery, a folder, an upload, a drawing by hand, what a crash left."""
