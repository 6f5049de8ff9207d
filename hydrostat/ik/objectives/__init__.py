"""What is wished for of a pose: each objective in a file of its own."""
