"""The studio: pose a robot by hand, watch it design itself, drive it, take it home. `Session` is all of it but the face."""
