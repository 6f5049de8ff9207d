"""Molds for bodies of foam."""
