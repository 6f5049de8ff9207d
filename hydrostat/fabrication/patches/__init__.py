"""The pattern of a plush body in space: its skin cut into patches, each laid flat."""
