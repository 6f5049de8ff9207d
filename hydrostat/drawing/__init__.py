"""How shapes become pictures: cameras, depths, lines, shades and colours, for figures and for pages on paper."""
