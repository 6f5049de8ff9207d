"""The laser pattern of a plush robot: panels, holes, labels, and the files that carry them."""
