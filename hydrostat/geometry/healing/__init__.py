"""One closed body from a dirty surface."""
