"""Print docs/materials.md from the table of materials: python docs/materials.py."""

from pathlib import Path

from hydrostat.robot import MATERIALS

PAGE = Path(__file__).with_suffix(".md")

INTRODUCTION = """\
# Materials

Printed by `python docs/materials.py` from `hydrostat/robot/materials.py`; `hydrostat materials` shows the same in a
terminal. Any of the names goes into robot.toml as `material = "ecoflex 00-30"`.

**What the numbers are.** hydrostat's body is Neo-Hookean, with Young's modulus and Poisson's ratio at small strain.
Rubbers are given so that the stress at twice the length is that of the data sheet: E = 3 / 1.75 of the 100 % modulus.
The 100 % modulus itself is *not* Young's modulus, though it is often taken for it. Foams are stiff for 5 to 10 % of
squeeze, then their walls buckle; one modulus cannot say that. The range is how far the numbers are believed, in percent
of the length: squeezed to stretched.

**What they decide.** Where cables lead the body follows from lengths and hardly from stiffness, if nothing but cables
pull; tensions are proportional to Young's modulus, and sag under weight is inversely so. A factor of two is a common
difference between two sources for the same material. Measure a sample before believing a tension.

**Nearly incompressible materials** (Poisson's ratio 0.48 and above) make linear elements lock: write
`volume = "patch"` ([decision 0012](decisions/0012-locking.md)).

**What was read.** At first hand: the tensile curves of the silicones, the data sheet of the polyethylene foam, and the
abstracts of the papers on PDMS and on Poisson's ratio of foam. At second hand, from public programs that quote them:
the 100 % moduli and densities of the silicones, the fit to flexfoam-it v and Allard's foam. Quoted without the source
at hand: elongations at break, NinjaFlex, the density of Mold Max 30, Gent's and Gibson's laws, how the maker names its
foams. What is assumed is called so.

"The thesis" is [this one](thesis.md).
"""


def page() -> str:
    """The whole page."""
    rows = [
        f"| {material.name} | {material.density:.0f} | {material.young_text} | {material.poisson:.2f} "
        f"| {material.range_text} |"
        for material in MATERIALS.values()
    ]
    table = "\n".join(["| name | density kg/m^3 | Young | Poisson | range |", "|---|---|---|---|---|", *rows])
    sources = "\n".join(
        f"- **{material.name}**: {material.source}. {material.note}".rstrip() for material in MATERIALS.values()
    )
    return f"{INTRODUCTION}\n{table}\n\n## Where the numbers come from, and who disagrees\n\n{sources}\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
