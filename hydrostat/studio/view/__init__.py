"""Content of the studio's view as plain records (bodies, dots, lines, ghosts, clouds, zones) and as bytes."""
