"""The face of the studio: its pages, panels and the stream to the screen."""
