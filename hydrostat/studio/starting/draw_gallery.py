"""`python -m hydrostat.studio.starting.draw_gallery`: the pictures of the gallery, made anew after a robot changed."""

import io
from pathlib import Path

from PIL import Image

from hydrostat.plot import draw_portrait, drawing
from hydrostat.robot import Robot, gallery_folder, list_gallery, load_robot, replace_file

PICTURES = Path(__file__).parent / "pictures"  # where the pictures are, as NAME.webp
WIDE, HIGH = 400, 300  # pixels of a picture; it is shown half as large
BORDER = 16  # pixels that are left free all round


def draw_picture(robot: Robot) -> bytes:
    """The robot at rest on clear ground, so that it may stand on light and dark pages, as WebP."""
    buffer = io.BytesIO()
    figure = draw_portrait(robot, robot.body.mesh.nodes)
    with drawing():
        figure.savefig(buffer, format="png", dpi=300, transparent=True)
    image = Image.open(buffer).convert("RGBA")
    image = image.crop(image.getchannel("A").getbbox())
    image.thumbnail((WIDE - 2 * BORDER, HIGH - 2 * BORDER), Image.Resampling.LANCZOS)
    sheet = Image.new("RGBA", (WIDE, HIGH), (0, 0, 0, 0))
    sheet.paste(image, ((WIDE - image.width) // 2, (HIGH - image.height) // 2))
    result = io.BytesIO()
    sheet.save(result, format="WEBP", quality=70, method=6)
    return result.getvalue()


def main() -> None:
    """Draw all robots of the gallery."""
    PICTURES.mkdir(exist_ok=True)
    for name in list_gallery():
        replace_file(PICTURES / f"{name}.webp", draw_picture(load_robot(gallery_folder(name))))


if __name__ == "__main__":
    main()
