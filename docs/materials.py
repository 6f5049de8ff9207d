"""Print docs/materials.md from the table of materials: python docs/materials.py."""

from math import log
from pathlib import Path

from hydrostat.robot import FOAMS, MATERIALS, Material

PAGE = Path(__file__).with_suffix(".md")

INTRODUCTION = """\
# Materials

Printed by `python docs/materials.py` from `hydrostat/robot/materials.py`; `hydrostat materials` shows the same in a
terminal. Write one of the names into robot.toml: `material = "ecoflex 00-30"`.

**What the numbers are.** Without `law = "foam"`, the body is Neo-Hookean, with Young's modulus and Poisson's ratio at
small strain. For rubbers, Young's modulus is chosen so that the stress at twice the length is that of the data sheet:
E = 3 / 1.75 of the 100 % modulus. The 100 % modulus itself is *not* Young's modulus, though it is often taken for it.
Foams are stiff for the first 5 to 10 % of compression; then their walls buckle. One modulus cannot describe this, but a
[foam law](#foam-laws) can. The range states how far the numbers can be trusted, in percent of the length, from
compression to stretch.

**What they affect.** If only cables act on a body, its poses depend on lengths and hardly on stiffness. Tensions are
proportional to Young's modulus, and sag under weight is inversely proportional to it. Two sources for the same material
often differ by a factor of two. Measure a sample before you trust a tension.

**Nearly incompressible materials** (Poisson's ratio 0.48 and above) make linear elements lock: write
`volume = "patch"` ([decision 0012](decisions/0012-locking.md)).

**Sources.** We read the tensile curves of the silicones, the data sheet of the polyethylene foam, and the abstracts of
the papers on PDMS and on Poisson's ratio of foam. The 100 % moduli and densities of the silicones, the fit to
flexfoam-it v, and Allard's foam come from public programs that quote their sources. The elongations at break,
NinjaFlex, the density of Mold Max 30, Gent's and Gibson's laws, the manufacturer's names for its foams, and van Wyk's
law are quoted from memory. Assumed values are marked as assumed.

Chang (2018) is [this thesis](thesis.md).
"""

OWN = """\
## Own materials

`hydrostat identify my_robot measured.csv --out build/fitted --save-material "gray felt"` adds the fitted material of
the body to `~/.config/hydrostat/materials.toml` (on Windows, in `%LOCALAPPDATA%\\hydrostat`; or to the file that
`HYDROSTAT_MATERIALS` names). You can also write this file by hand:

```toml
[[material]]
name = "gray felt"
young = "22 kPa"
young_interval = ["20.8 kPa", "23.8 kPa"]   # 95 %; optional
poisson = 0.3
density = "40 kg/m^3"
source = "hydrostat identify, 10 rows of measured.csv"
```

The other keys are those of a material in [robot.toml](robot_toml.md). Use the name like those in the table, also in the
studio and in `robot.with_material("gray felt")`. Designs take the interval as the uncertainty of Young's modulus. A
saved robot holds the values, not the name, so it is the same on another computer.
"""

FOAM = """\
## Foam laws

Write `material = {{ name = "polyurethane foam", law = "foam" }}` for a body that is compressed by more than 20 %, or
give your own terms ([robot.toml](robot_toml.md#foam-laws)). Young's modulus and Poisson's ratio are those of the law.

{table}

{sources}

Stress in kPa under compression with free sides, by the foam law / by the Neo-Hookean law with the numbers of the first
table:

{stresses}
"""

DAMPING = """\
## Damping

Motion is undamped unless you write a [viscosity](robot_toml.md#viscous-materials). With `viscosity = "material at 7
Hz"`, the material has the loss factor of the table at 7 Hz: the viscosity is loss factor x shear modulus / (2 pi f).
`"material"` alone means 2 Hz. In Python, write `material.with_damping(7.0)`. Use the frequency at which the robot
swings, the first one of `find_modes(simulation)`: 7.2 Hz for the starfish. At Poisson's ratio 0, the damping ratio of
that mode is then half the loss factor; in a flat body at 0.3, it is 17 % less. The damping ratios of other modes are
proportional to their frequencies; real loss factors change less. Air in cells, seams and cables add damping that is not
in the table.

{table}

We know Allard's and Ge's tables, natural rubber, the hobbyist's test and the figure on liquid crystal elastomers only
from public programs or pages that quote them. Assumed values may be off by a factor of three. Measure your material:
let a limb swing and count n swings until the amplitude has halved. The loss factor is 0.22 / n.

"""

HYSTERESIS = """\
## Hysteresis

No material has [hysteresis](robot_toml.md#hysteresis) by default. `hysteresis = "material"`, or in Python
`material.with_hysteresis()`, takes the values of this table, except those of dense foam, which has no name. The sliders
are shares of Young's modulus. The loss, in closed form, is the share of the work of a stretch from rest to 25 % that
does not return on the way back. The strain kept is the maximum that a bar keeps when it is released.

{table}

- **foams**: a foam manufacturer reports losses in the indentation test of 35 to 40 % for slabs of 20 kg/m^3, 30 to
  35 % at 24 kg/m^3, and 21 to 26 % for dense reinforced foam (quoted by others; we have not read the paper). The shares
  and strains are assumed, such that the loss lies within these ranges.
- **polyester fibre**: assumed, because we found no loss. The fibers slide on each other from the first compression. The
  loss may be off by a factor of three.
- **silicones, TPU**: none. Their loss depends on the rate: write `relaxation`.

If the left winch of the polyester starfish goes to 30 mm and back, 22 % of the work is lost, and the tip keeps 6.9 of
40.1 mm. [Example 28](../examples/python) prints this and draws the loop.

To measure your robot, pull it half way, all the way, back to half and back to 0, and compare the markers of both
strokes. Cable friction makes them differ, too.
"""

DENSE_FOAM = ((0.3, 0.02), (0.25, 0.1))
"""Share of Young's modulus and strain of each slider of dense foam, which is no material of the table."""

SQUEEZES = 0.1, 0.25, 0.4, 0.6


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
    return (
        f"{INTRODUCTION}\n{table}\n\n{OWN}\n## Sources, and differences between them\n\n{sources}\n\n"
        f"{foam_chapter()}\n{damping_chapter()}{hysteresis_chapter()}"
    )


def damping_chapter() -> str:
    """Chapter on loss factors."""
    rows = []
    for material in MATERIALS.values():
        viscosity = float(f"{material.with_damping(2.0).viscosity:.2g}")
        rows.append(f"| {material.name} | {material.loss_factor:g} | {viscosity:.0f} Pa s | {material.loss_source} |")
    head = ["| name | loss factor | viscosity at 2 Hz | source of the loss factor |", "|---|---|---|---|"]
    return DAMPING.format(table="\n".join([*head, *rows]))


def hysteresis_chapter() -> str:
    """Chapter on values of hysteresis."""
    rows = []
    known = [MATERIALS[name] for name in ("polyurethane foam", "polyester fibre")]
    shares = {
        one.name: tuple((slider.young / one.young, slider.strain) for slider in one.with_hysteresis().hysteresis)
        for one in known
    }
    for name, sliders in {**shares, "dense polyurethane foam": DENSE_FOAM}.items():
        loss, kept = hysteresis_loss(sliders, 0.25), sum(share * strain for share, strain in sliders)
        words = ", ".join(f"{100 * share:.3g} % at {strain:g}" for share, strain in sliders)
        rows.append(f"| {name} | {words} | {100 * loss:.0f} % | {100 * kept:.1f} % |")
    head = ["| filling | share of Young's modulus, strain | loss at 25 % | strain kept, at most |", "|---|---|---|---|"]
    return HYSTERESIS.format(table="\n".join([*head, *rows]))


def hysteresis_loss(sliders: tuple[tuple[float, float], ...], most: float) -> float:
    """Part of the work of a stretch from rest to `most` that is lost there and back, per unit of Young's modulus."""
    up = most**2 / 2 + sum(share * strain * (most - strain / 2) for share, strain in sliders)
    return sum(share * strain * (2 * most - 2.5 * strain) for share, strain in sliders) / up


def foam_chapter() -> str:
    """Chapter on materials with a foam law."""
    rows = [
        f"| {foam.name} | {foam.young_text} | {foam.poisson:.2f} "
        f"| {', '.join(f'{100 * term.share:.3g} %: {term.exponent:g}' for term in foam.foam)} |"
        for foam in FOAMS.values()
    ]
    table = "\n".join(["| name | Young | Poisson | share: exponent |", "|---|---|---|---|", *rows])
    sources = "\n".join(f"- **{foam.name}**: {foam.source}." for foam in FOAMS.values())
    head = " | ".join(f"{100 * squeeze:.0f} %" for squeeze in SQUEEZES)
    stresses = [f"| name | {head} |", "|---" * (1 + len(SQUEEZES)) + "|"]
    for name, foam in FOAMS.items():
        pairs = [
            f"{foam_stress(foam, 1 - squeeze) / 1e3:.3g} / {rubber_stress(MATERIALS[name], 1 - squeeze) / 1e3:.3g}"
            for squeeze in SQUEEZES
        ]
        stresses.append(f"| {name} | {' | '.join(pairs)} |")
    return FOAM.format(table=table, sources=sources, stresses="\n".join(stresses))


def foam_stress(material: Material, stretch: float) -> float:
    """Pressure that squeezes foam to a stretch, sides free, over the area at rest [Pa]."""
    mu, nu = material.lame[0], material.poisson
    terms = [(2 * mu * term.share / term.exponent, term.exponent) for term in material.foam]
    return sum(scale * (stretch ** (-1 - alpha * nu) - stretch ** (alpha - 1)) for scale, alpha in terms)


def rubber_stress(material: Material, stretch: float) -> float:
    """Pressure that squeezes a Neo-Hookean material likewise [Pa]."""
    mu, lame = material.lame
    low, side, high = 0.5, 1.0, 3.0
    for _ in range(60):  # bisection for the stretch sideways that leaves no stress there
        side = 0.5 * (low + high)
        low, high = (low, side) if mu * (side**2 - 1) + lame * log(stretch * side**2) > 0 else (side, high)
    return mu * (1 / stretch - stretch) - lame * log(stretch * side**2) / stretch


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
