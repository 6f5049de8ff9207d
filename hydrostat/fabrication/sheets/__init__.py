"""Pages of paper: the assembly sheet and the pattern in tiles, with their drawings."""
