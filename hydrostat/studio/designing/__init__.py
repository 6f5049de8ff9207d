"""Winches and cables found while one looks on."""
