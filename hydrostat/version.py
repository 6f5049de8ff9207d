"""Version of hydrostat."""

__version__ = "0.1.0"
