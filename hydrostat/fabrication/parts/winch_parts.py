"""`WinchParts`: the solids of winches; equal ones are made once and share a name."""

from manifold3d import Manifold

from hydrostat.fabrication.parts.housing import Housing
from hydrostat.fabrication.solids.assembly import Assembly, Placed
from hydrostat.fabrication.solids.construct import Construction, solid_of
from hydrostat.fabrication.solids.printed import Printed

_SPOOL = "Stands on its wide face with the bore, no support; 0.12 mm layers, 4 walls or more."
_BOX = "Roof on the bed, open side up, no support. Open the channels with a needle; push a tube in to try its seats."
_PLATE = "Motor's side on the bed, no support."
_COUPLING = "Disc on the bed, shaft up, no support; 0.12 mm layers, all walls (100 % infill)."


class WinchParts:
    """Makes what is printed for winches and remembers it, so that winches that are alike share their files."""

    def __init__(self) -> None:
        self._made: dict[str, dict[Construction, Printed]] = {}
        self._motors: dict[str, Manifold] = {}

    def of(self, housing: Housing, winch: str) -> tuple[tuple[Printed, ...], Assembly]:
        """What is printed for a winch: spool, box, plate, and the coupling of a servo; and all of it put together."""
        box = housing.box().turned(x=180).moved(0, 0, housing.top)
        printed = [
            self._printed("spool", "Spool", housing.spool.construction(), _SPOOL),
            self._printed("housing", "Housing", box, _BOX),
            self._printed("motor_plate", "Motor plate", housing.plate(), _PLATE),
        ]
        coupling = housing.coupling()
        if coupling is not None:
            printed.append(self._printed("coupling", "Coupling", coupling, _COUPLING))
        return tuple(printed), self._assembly(housing, tuple(printed), winch)

    def _printed(self, kind: str, title: str, model: Construction, note: str) -> Printed:
        made = self._made.setdefault(kind, {})
        if model not in made:
            name = f"{kind}_{letters(len(made))}"
            made[model] = Printed(name=name, title=title, solid=solid_of(model), note=note, model=model)
        return made[model]

    def _assembly(self, housing: Housing, printed: tuple[Printed, ...], winch: str) -> Assembly:
        motor, drive = housing.motor, housing.drive
        if motor.key not in self._motors:
            self._motors[motor.key] = solid_of(motor.envelope)
        spool, box, plate, *coupling = printed
        step = 0.6 * housing.top
        pieces = [
            Placed(name=f"motor_{motor.key}", title=motor.title, solid=self._motors[motor.key], printed=False),
            Placed(name=plate.name, title=plate.title, solid=plate.solid, pulled=(0, 0, step)),
        ]
        if motor.horn is not None:
            (disc,) = coupling
            solid = disc.solid.translate((0, 0, motor.horn.height))
            pieces.append(Placed(name=disc.name, title=disc.title, solid=solid, pulled=(0, 0, 2 * step)))
        far = step * len(pieces)
        standing = spool.solid.translate((0, 0, drive.start))
        closed = box.solid.rotate((180, 0, 0)).translate((0, 0, housing.top))
        pieces += [
            Placed(name=spool.name, title=spool.title, solid=standing, pulled=(0, 0, far + step)),
            Placed(name=box.name, title=box.title, solid=closed, pulled=(0, 0, far + 3 * step)),
        ]
        return Assembly(name=f'winch "{winch}"', pieces=tuple(pieces))


def letters(number: int) -> str:
    """a, b, ... z, aa, ab, ... for 0, 1, ..."""
    text = chr(ord("a") + number % 26)
    return text if number < 26 else letters(number // 26 - 1) + text
