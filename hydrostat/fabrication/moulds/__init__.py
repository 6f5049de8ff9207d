"""Moulds for bodies of foam."""
