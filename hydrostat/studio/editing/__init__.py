"""Pins, markers, winches and cables placed and moved by hand."""
