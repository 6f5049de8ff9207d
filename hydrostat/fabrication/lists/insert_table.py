"""`insert_table`: parts and rods that are put into the body, with their places and steps."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated

from hydrostat.fabrication.inserts import Insert
from hydrostat.fabrication.lists.table import Table, number_column, text_column


@dataclass(frozen=True, kw_only=True)
class InsertRow:
    """Part or rod in the body."""

    mark: Annotated[str, text_column("mark")]
    name: Annotated[str, text_column("name")]
    kind: Annotated[str, text_column("kind")]
    material: Annotated[str, text_column("material")]
    size: Annotated[str, text_column("size")]
    where: Annotated[str, text_column("place")]
    length: Annotated[float | None, number_column("length", "mm")]
    diameter: Annotated[float | None, number_column("diameter", "mm", decimals=2)]
    volume: Annotated[float | None, number_column("volume", "cm^3", decimals=2)]
    mass: Annotated[float | None, number_column("mass", "g")]
    step: Annotated[str, text_column("step")]


def insert_table(inserts: Iterable[Insert], step: str) -> Table[InsertRow]:
    """Table of parts and rods, all of which one step puts in."""
    rows = [
        InsertRow(
            mark=insert.mark,
            name=insert.name,
            kind=insert.kind,
            material=insert.material,
            size=insert.size,
            where=insert.where,
            length=insert.length,
            diameter=insert.diameter,
            volume=None if insert.volume is None else 1e-3 * insert.volume,
            mass=insert.mass,
            step=step,
        )
        for insert in inserts
    ]
    return Table(
        name="inserts",
        title="Parts and rods in the body",
        row=InsertRow,
        rows=tuple(rows),
        notes=(
            "Sizes are as drawn, volumes and masses those of the simulated mesh.",
            "The kit has no file for these parts: print, cut or cast them.",
        ),
    )
