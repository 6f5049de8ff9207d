"""Checks of a network by its constraints: a plain sentence for each place where one is violated."""
