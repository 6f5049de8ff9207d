"""`material_words`, `young_words`: what a material is like, in words with numbers."""

from hydrostat.robot import Material

_SOFTNESS = ((20e3, "as soft as jelly"), (100e3, "soft"), (500e3, "rather firm"), (2e6, "firm"))


def material_words(material: Material) -> str:
    """Such as "soft, Young's modulus 30 kPa, 40 kg/m3, may be squeezed by 60 % and stretched by 50 %"."""
    feel = next((words for most, words in _SOFTNESS if material.young < most), "stiff")
    words = f"{feel}, Young's modulus {young_words(material)}, {material.density:.0f} kg/m³"
    if material.largest_squeeze is None or material.largest_stretch is None:
        return words
    squeeze, stretch = 100 * material.largest_squeeze, 100 * (material.largest_stretch - 1)
    return f"{words}, may be squeezed by {squeeze:.0f} % and stretched by {stretch:.0f} %"


def young_words(material: Material) -> str:
    """Young's modulus to three digits, such as "30 kPa"."""
    return f"{material.young / 1e6:.3g} MPa" if material.young >= 1e6 else f"{material.young / 1e3:.3g} kPa"
