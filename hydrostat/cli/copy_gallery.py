"""`copy_gallery`: a robot of the gallery as a folder of your own."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hydrostat.ik import NewRobotWish


def copy_gallery(source: str, folder: Path, wish: "NewRobotWish", *, on_skin: bool) -> list[str]:
    """Copy a robot under its new name, if asked with other elements or with its cables on the skin.

    Returns:
        Notes for people.

    Raises:
        InputError: a wish that a gallery robot does not have, or cables that cannot lie on the skin.
    """
    from hydrostat.files import replace_file
    from hydrostat.robot import GALLERY, gallery_folder, lay_cables_on_skin, load_robot, merged_text, with_values

    wish.refuse(
        "not available for gallery robots. Edit robot.toml",
        "size",
        "thickness",
        "inflate",
        "material",
        "inner",
        "drawing_part",
    )
    shelf = gallery_folder(source.removeprefix(GALLERY))
    files = {file.name: file.read_bytes() for file in sorted(shelf.iterdir()) if file.is_file()}
    wanted = wish.element_size if wish.nodes is None else load_robot(shelf).body.element_size_for(wish.nodes)
    text = files["robot.toml"].decode()
    laid = lay_cables_on_skin(load_robot(shelf)) if on_skin else None
    text = text if laid is None else merged_text(text, laid)
    files["robot.toml"] = with_values(text, name=wish.name, element_size=wanted).encode()
    for file, content in files.items():
        replace_file(folder / file, content)
    if laid is None:
        return []
    return ["note: cables moved to the skin. Poses were made with cables inside: see their errors with hydrostat pose"]
