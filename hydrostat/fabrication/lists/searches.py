"""Search terms for the bill of materials: words to type into the search box of a shop."""

import re
from types import MappingProxyType

SEARCHES = MappingProxyType(
    {
        "felt": "wool or polyester felt by the meter",
        "thread": "polyester sewing thread 100 m",
        "filling": "polyester toy filling",
        "zipper": "nylon {kind}",
        "needle": "long doll needle and hand sewing needles",
        "decoration": "felt scraps and embroidery thread",
        "line": "braided PE fishing line {all}",
        "tube": "PTFE tube {all}",
        "uno board": "{kind} R3",
        "mega board": "{kind} 2560",
        "esp32 board": "{kind}",
        "shifter": "logic level converter {all}",
        "servo board": "ROBOTIS OpenRB-150",
        "bus adapter": "Waveshare bus servo adapter",
        "driver": "DRV8874 motor driver carrier",
        "supply": "power supply {all}",
        "fuse": "inline holder with {all}",
        "switch": "toggle switch {kind}",
        "lead": "two-core copper cable {all}",
        "servo cable": "three-wire servo cable {kind}",
        "servo's own cable": "three-wire servo cable {kind}",
        "encoder": "encoder for micro metal gearmotor",
        "USB supply": "USB charger or power bank 5 V",
        "small parts": "resistor kit, capacitors, LEDs, jumper wires",
        "screws": "{kind}",
        "pla": "PLA filament 1.75 mm",
        "flexible filament": "flexible filament {kind}",
        "foam": "{kind} flexible foam kit",
        "silicone": "{kind} silicone rubber kit",
        "release": "mold release spray for {all}",
        "glue": "spray adhesive for foam",
        "sealer": "shellac or acrylic varnish",
        "clay": "modeling clay without sulfur",
        "plastic glue": "plastic glue for PLA",
        "bolts": "M4 bolt and nut, or threaded rod",
        "rod": "rod of 3 mm, wood or steel",
        "skin": "{kind}",
        "wire": "rod {all}",
        "soft part": "{kind}",
        "stiff part": "{kind}",
    }
)
"""By the key of the price. kind: what the specification begins with; all: the whole specification."""

UNNAMED = "as the robot file says"
"""Specification of a material without a name."""

_REMOVED = (" or more", " or thicker", " or longer", " or alike", "for ", "of three wires with ", "plugs of ", UNNAMED)
"""Words of specifications that find nothing in a shop."""


def search_term(key: str, specification: str) -> str:
    """Words to search for in a shop, by the key of a price (empty: a motor) and the specification of the part."""
    words = re.sub(r" \([^)]*\)", "", specification)  # a screw's place, a shop's number
    for removed in _REMOVED:
        words = words.replace(removed, "")
    kind = words.partition(",")[0]
    return SEARCHES[key].format(kind=kind, all=words.replace(",", "")).strip() if key else words
