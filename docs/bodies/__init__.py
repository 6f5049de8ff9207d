"""The robots in space of the gallery, one file each."""
