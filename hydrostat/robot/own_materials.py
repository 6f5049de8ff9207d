"""`own_materials`, `save_own_material`: the user's own materials, such as `hydrostat identify` measures, in a file."""

import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from hydrostat.errors import InputError
from hydrostat.files import read_text, replace_file
from hydrostat.given import check_name
from hydrostat.robot.material import Material
from hydrostat.robot.material_table import material_of, material_values
from hydrostat.robot.tables_file import TablesFile

if TYPE_CHECKING:
    from hydrostat.toml_schema import TomlTable

VARIABLE = "HYDROSTAT_MATERIALS"
"""Environment variable that names another file."""


def own_materials() -> dict[str, Material]:
    """Materials of the user's own file by name; none where there is no file (InputError: a file that is wrong)."""
    path = own_file()
    return _OwnMaterials(path, read_text(path)).materials() if path is not None and path.exists() else {}


def save_own_material(material: Material) -> Path:
    """Write a material with its name and source into the user's own file, in place of one of that name.

    Raises:
        InputError: a name that is not allowed, or a file that is wrong or cannot be written.
    """
    import tomlkit

    path = own_file()
    if path is None:
        raise InputError(f"no home folder for your materials. Set {VARIABLE} to the path of a file.")
    check_name(material.name)
    known = own_materials()  # a wrong file stays as it is
    document = tomlkit.parse(read_text(path) if path.exists() else "")
    values = {"name": material.name, **material_values(material)}
    values |= {"source": material.source} if material.source else {}
    entries = document.setdefault("material", tomlkit.aot())
    if (name := material.name.lower()) not in known:
        entries.append(tomlkit.table())
    entry = entries[[*known, name].index(name)]
    for key in set(entry) - set(values):
        del entry[key]
    entry.update(values)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{path.parent}: cannot be made a folder ({error.strerror})") from None
    return replace_file(path, tomlkit.dumps(document).encode())


def own_file() -> Path | None:
    """Path of the file, which need not exist; None without a home folder."""
    if named := os.environ.get(VARIABLE):
        return Path(named)
    try:
        home = Path.home()
    except RuntimeError:
        return None
    variable, folder = ("LOCALAPPDATA", home) if sys.platform == "win32" else ("XDG_CONFIG_HOME", home / ".config")
    return Path(os.environ.get(variable) or folder) / "hydrostat" / "materials.toml"


class _OwnMaterials(TablesFile):
    """Reader of the file."""

    kind = "materials"
    empty = None

    def form(self) -> "type[TomlTable]":
        from hydrostat.robot.material_schema import OwnMaterialsTable

        return OwnMaterialsTable

    def materials(self) -> dict[str, Material]:
        """Materials by name in small letters."""
        found: dict[str, Material] = {}
        for index, entry in enumerate(self.table.material):
            material = self.at(f"material[{index}]", lambda entry=entry: material_of(entry))
            if entry.name.lower() in found:
                self.fail(f"material[{index}].name", "there are two of this name; names must be unique")
            found[entry.name.lower()] = replace(material, name=entry.name, source=entry.source or "")
        return found
