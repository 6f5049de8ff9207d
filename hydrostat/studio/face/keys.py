"""The keys of the studio, as the help page lists them."""

KEYS = (
    (("G",), "move what is chosen: click or drag to where it should go"),
    (("R",), "back to rest"),
    (("Z",), "undo"),
    (("Shift", "Z"), "do again"),
    (("Space",), "play, or stop playing"),
    (("1", "3", "7"), "view from the front, the side, the top"),
    (("Delete",), "remove what is chosen"),
    (("Esc",), "choose nothing; stop what was begun"),
    (("Ctrl", "S"), "save"),
    (("?",), "this help"),
)
"""Keys, and what they do."""
