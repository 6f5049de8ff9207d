"""Sizes of a man's hand from published measurements.

Lengths of bones: means of radiographs of 66 adults (Buryanov and Kotiuk 2010, "Proportions of hand segments", Int. J.
Morphol. 28(3), 755-758), from the base of the metacarpal to the tip of the distal phalanx, with the soft tissue beyond.

Outer sizes: median of British men (Pheasant and Haslegrave 2006, "Bodyspace", 3rd edition, table of the hand), as it is
commonly quoted. A survey in the USA agrees where it has the same sizes (FAA Human Factors Design Standard, appendix on
the anthropometry of technical staff; men, median): length 196 mm, breadth 88 mm, index finger 21 mm broad.

Where the bases of the metacarpals lie, and how broad the fingers are that the tables leave out, is not in these
sources: see `hand.py`, where such numbers are called assumed.
"""

from types import MappingProxyType

FINGERS = ("thumb", "index", "middle", "ring", "little")  # names in the order of the rays

METACARPALS = MappingProxyType(
    {"thumb": 46.22e-3, "index": 68.12e-3, "middle": 64.60e-3, "ring": 58.00e-3, "little": 53.69e-3}
)
"""Length of the metacarpal bones [m] (Buryanov and Kotiuk 2010)."""

PHALANGES = MappingProxyType(
    {
        "thumb": (31.57e-3, 21.67e-3),
        "index": (39.78e-3, 22.38e-3, 15.82e-3),
        "middle": (44.63e-3, 26.33e-3, 17.40e-3),
        "ring": (41.37e-3, 25.65e-3, 17.30e-3),
        "little": (32.74e-3, 18.11e-3, 15.96e-3),
    }
)
"""Length of the phalanges from the knuckle on [m] (Buryanov and Kotiuk 2010)."""

SOFT_TIPS = MappingProxyType(
    {"thumb": 5.67e-3, "index": 3.84e-3, "middle": 3.95e-3, "ring": 3.95e-3, "little": 3.73e-3}
)
"""Soft tissue beyond the last bone [m] (Buryanov and Kotiuk 2010)."""

HAND_LENGTH = 189e-3
"""Length from the crease of the wrist to the tip of the middle finger [m] (Pheasant and Haslegrave 2006)."""

HAND_BREADTH = 87e-3  # across the knuckles of the four fingers [m] (Pheasant and Haslegrave 2006)

HAND_THICKNESS = 33e-3
"""Thickness from back to palm at the knuckle of the middle finger [m] (Pheasant and Haslegrave 2006)."""

INDEX_BREADTH, INDEX_THICKNESS = 21e-3, 19e-3
"""Sizes of the index finger at its middle joint [m] (Pheasant and Haslegrave 2006)."""

THUMB_BREADTH, THUMB_THICKNESS = 23e-3, 22e-3  # sizes of the thumb at its last joint [m] (Pheasant and Haslegrave 2006)
