"""What the studio shows, as plain records: bodies, dots, lines, ghosts, clouds and zones; and as bytes for a screen."""
