"""The studio: pose a robot by hand, watch it design itself, drive it, take it home. Begin reading at `session.py`."""
