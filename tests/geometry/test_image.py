import io
from collections.abc import Callable

import numpy as np
import pytest
from drawings import canvas, disc, dxf, fish, lit, noisy, picture, shadowed, shape, star
from PIL import Image, PngImagePlugin
from shapely import Polygon, get_coordinates, hausdorff_distance, segmentize

from hydrostat.errors import InputError, OutlineError
from hydrostat.geometry.files.outline_file import read_drawing, read_outline
from hydrostat.geometry.outline import Outline

STAR = star()
SIZE = 0.2

DISCS: dict[str, Callable[[], bytes]] = {
    "dark on light": lambda: picture(canvas(disc("black"))),
    "light on dark": lambda: picture(canvas(disc((240, 230, 200)), ground=(30, 40, 60))),
    "of 1 bit": lambda: picture(canvas(disc("black"), fine=1).convert("1")),
    "in a palette": lambda: picture(canvas(disc("green")).quantize(16)),
    "of 16 bits": lambda: picture(
        Image.fromarray(65535 - np.asarray(canvas(disc("white"), ground="black").convert("L"), np.uint16) * 200)
    ),
    "of grey and opacity": lambda: picture(canvas(disc((9, 9, 9, 255)), ground=(0, 0, 0, 0)).convert("LA")),
    "in CMYK": lambda: picture(canvas(disc("navy")).convert("CMYK"), "JPEG", quality=90),
    "transparent ground": lambda: picture(canvas(disc((90, 80, 70, 255)), ground=(90, 80, 70, 0))),
    "noise, fading light, JPEG 40": lambda: picture(noisy(lit(canvas(disc("orangered")), 0.3), 8), "JPEG", quality=40),
    "pale, with dark eyes": lambda: picture(
        noisy(canvas(disc((255, 220, 225)), disc("black", 20, (220, 220)), disc("black", 20, (380, 220))), 2)
    ),
    "drawn with a line": lambda: picture(canvas(disc("black"), disc("white", 244))),
    "drawn with a thin grey line": lambda: picture(
        noisy(canvas(disc("gray"), disc("white", 247)), 3), "JPEG", quality=70
    ),
    "photograph of 2400 pixels": lambda: picture(
        canvas(disc("navy")).resize((2400, 2400), Image.Resampling.BICUBIC), "JPEG"
    ),
    "gradient": lambda: picture(noisy(lit(canvas(disc((60, 60, 160))), 0.5), 3)),
}


@pytest.mark.parametrize("draw", DISCS.values(), ids=DISCS.keys())
def test_disc(draw: Callable[[], bytes]) -> None:
    """Oracle: the disc's area, within 0.5 %, and its circle, within 1 % of its radius, in few corners."""
    outline = read_outline(draw(), name="a.png", size=SIZE)
    assert outline.area == pytest.approx(np.pi * 0.01, rel=5e-3)
    assert np.abs(np.linalg.norm(outline.exterior, axis=1) - 0.1).max() < 1e-3
    assert outline.size == pytest.approx(SIZE, rel=1e-12)
    assert 40 <= len(outline.exterior) <= 500
    assert outline.holes == ()


@pytest.mark.parametrize("one_bit", [False, True])
def test_no_stairs(one_bit: bool) -> None:
    """Oracle: a slanting bar, whose sides are straight: no corner turns but at its ends."""
    corners = np.array([(100, 300), (500, 330), (497, 370), (97, 340)], dtype=float)
    image = canvas(shape(corners, "black"), fine=1 if one_bit else 4)
    ring = read_outline(picture(image), name="a.png", size=SIZE).exterior
    ring = get_coordinates(segmentize(Polygon(ring), SIZE / 400))
    pixel = SIZE / 404
    inner = ring[np.abs(ring[:, 0]) < SIZE / 2 - 15 * pixel]
    slope = np.arctan2(30, 400)
    across = inner @ np.array([np.sin(slope), np.cos(slope)])
    assert len(inner) > 500
    assert np.abs(np.abs(across) - 0.5 * np.hypot(3, 40) * pixel).max() < 0.75 * pixel
    sides = np.diff(ring, axis=0)
    sides = sides[np.abs(ring[1:, 0]) < SIZE / 2 - 15 * pixel]
    turns = np.arctan2(sides[:, 1], sides[:, 0]) + slope
    assert np.abs((turns + np.pi / 2) % np.pi - np.pi / 2).max() < 0.1


@pytest.mark.slow
def test_same_shape_in_every_kind_of_file() -> None:
    """Oracle: one star as SVG, DXF, PNG and JPG: two the same, the others within some pixels."""
    path = " ".join(f"{x:.9f},{y:.9f}" for x, y in STAR)
    svg = f'<svg xmlns="http://www.w3.org/2000/svg"><polygon points="{path}"/></svg>'.encode()
    up = [(x, 600 - y) for x, y in STAR.tolist()]
    image = canvas(shape(STAR, "teal"))
    files = {
        "star.svg": svg,
        "star.dxf": dxf(lambda space, _: space.add_lwpolyline(up, close=True)),
        "star.png": picture(image),
        "star.jpg": picture(image, "JPEG", quality=85),
    }
    found = {name: read_outline(content, name=name, size=SIZE) for name, content in files.items()}
    drawn = found["star.svg"].polygon
    pixel = SIZE / float(np.ptp(STAR, axis=0).max())
    assert hausdorff_distance(drawn, found["star.dxf"].polygon) < 1e-9
    for name in ("star.png", "star.jpg"):
        assert found[name].area == pytest.approx(drawn.area, rel=0.02)  # blunt tips: a smaller box, so a larger scale
        assert hausdorff_distance(drawn, found[name].polygon, densify=0.02) < 3.5 * pixel  # its tips are rounded
        assert found[name].polygon.symmetric_difference(drawn).area < 0.8 * pixel * drawn.length


@pytest.mark.slow
def test_line_drawing_is_filled() -> None:
    """Oracle: the ellipse of the fish to the outer side of its line; its eye and mouth are no holes; it says so."""
    for content in (
        picture(canvas(fish)),
        picture(noisy(lit(canvas(lambda draw, fine: fish(draw, fine, 4, (90, 80, 120))), 0.3), 5), "JPEG", quality=40),
    ):
        drawing = read_drawing(content, name="fish.png", size=0.24)
        assert drawing.outline.holes == ()
        assert drawing.outline.area == pytest.approx(np.pi * 0.12 * 0.06, rel=5e-3)
        assert drawing.notes[0].startswith("a drawing of lines: filled to its outer line")


@pytest.mark.parametrize("cut", [0, 60])
def test_a_sheet_of_paper_on_a_table_is_the_ground(cut: float) -> None:
    """Oracle: the circle that is drawn on the sheet, which ends within the picture or runs beyond it."""
    sheet = shape(np.array([(60, 70), (560 + cut, 50), (545 + cut, 545), (75, 530)]), (225, 222, 215))
    drawn = disc("black", 150), disc((225, 222, 215), 145)
    photo = picture(noisy(lit(canvas(sheet, *drawn, ground=(110, 80, 60)), 0.2), 4), "JPEG", quality=80)
    drawing = read_drawing(photo, name="a.jpg", size=SIZE)
    assert drawing.outline.area == pytest.approx(np.pi * 0.01, rel=1e-2)
    assert drawing.notes[0] == "a sheet of paper was taken for the ground, and the table around it left out"
    bare = read_drawing(picture(canvas(sheet, ground=(110, 80, 60))), name="a.png", size=SIZE)
    assert bare.outline.area > 0.03, "a pillow without a drawing is a body"


@pytest.mark.parametrize("radius", [40, 90, 200])
def test_holes(radius: float) -> None:
    """Oracle: the ring's area; a hole in a filled body is kept, and counted."""
    drawing = read_drawing(picture(canvas(disc("red"), disc("white", radius))), name="a.png", size=SIZE)
    assert len(drawing.outline.holes) == 1
    assert drawing.outline.area == pytest.approx(np.pi * 0.01 * (1 - (radius / 250) ** 2), rel=5e-3)
    assert drawing.notes == ("kept 1 hole",)


@pytest.mark.slow
def test_pale_parts_and_eyes_are_no_holes() -> None:
    """Oracle: the disc's area: rings of other colors are body; the white of an eye, which holds a pupil, is filled."""
    rings = canvas(disc("red"), disc((255, 235, 120), 200), disc("navy", 150), disc((255, 200, 60), 60))
    eye = canvas(disc("orange"), disc("white", 40, (200, 250)), disc("black", 12, (200, 250)))
    for image, notes in ((rings, 0), (eye, 1)):
        drawing = read_drawing(picture(image), name="a.png", size=SIZE)
        assert drawing.outline.holes == ()
        assert drawing.outline.area == pytest.approx(np.pi * 0.01, rel=5e-3)
        assert len(drawing.notes) == notes
    assert drawing.notes[0].startswith("filled 1 hole, the largest 32 mm across at (-40.0, 20.0) mm")


def test_small_things_are_named() -> None:
    """Oracle: what was drawn: two specks and a hole too small to be meant, with size and place."""
    image = canvas(
        disc("red"), disc("white", 10, (300, 200)), disc("black", 5, (30, 30)), disc("black", 12, (570, 570))
    )
    drawing = read_drawing(picture(image), name="a.png", size=SIZE)
    filled, specks = drawing.notes
    assert filled == "filled 1 hole, the largest 8 mm across at (0.0, 40.0) mm"
    assert specks.startswith("left out 2 specks beside the body, the largest ")
    assert "at (108.0, -108.0) mm" in specks
    assert drawing.outline.area == pytest.approx(np.pi * 0.01, rel=5e-3)


def test_soft_shadow_is_left_out() -> None:
    """Oracle: the star without its shadow, and a note of it."""
    image = shadowed(canvas(shape(STAR, (150, 40, 60)), ground=(235, 230, 225)),
                     canvas(shape(STAR, "white"), ground="black"), 0.3)  # fmt: skip
    drawing = read_drawing(picture(noisy(image, 3), "JPEG", quality=60), name="a.jpg", size=SIZE)
    pixel = SIZE / float(np.ptp(STAR, axis=0).max())
    assert drawing.outline.area == pytest.approx(Polygon(STAR).area * pixel**2, rel=0.02)
    assert "shadow" in drawing.notes[0]


@pytest.mark.slow
def test_upright_as_the_camera_says() -> None:
    """Oracle: the orientations of EXIF: the same picture turned in the file and turned back by its tag."""
    upright = canvas(shape(np.array([(100, 100), (500, 100), (500, 200), (200, 200), (200, 500), (100, 500)]), "black"))
    turned = {1: upright, 3: upright.rotate(180), 6: upright.rotate(90), 8: upright.rotate(270)}
    shapes = []
    for tag, image in turned.items():
        exif = Image.Exif()
        exif[0x0112] = tag
        shapes.append(read_outline(picture(image, "JPEG", quality=95, exif=exif), name="a.jpg", size=SIZE).polygon)
    for other in shapes[1:]:
        assert shapes[0].symmetric_difference(other).area < 0.01 * shapes[0].area


def test_body_at_the_border() -> None:
    """Oracle: the disc with a cap cut off by the border: closed there, and said."""
    drawing = read_drawing(picture(canvas(disc("navy", 250, (150, 300)))), name="a.png", size=SIZE)
    share = (np.pi - np.arccos(0.6) + 0.6 * 0.8) / np.pi
    assert drawing.outline.area == pytest.approx(np.pi * 0.01 * share, rel=1e-2)
    assert drawing.notes == ("the body reaches the border of the picture and is cut off there",)


@pytest.mark.slow
def test_corners_stay_few() -> None:
    """Oracle: the promise of at most 2000 corners, for a body with 600 teeth."""
    angle = np.linspace(0, 2 * np.pi, 1200, endpoint=False)
    radius = np.where(np.arange(1200) % 2 == 0, 480, 440)
    gear = 500 + np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    outline = read_outline(picture(canvas(shape(gear, "black"), size=(1000, 1000), fine=2)), name="a.png", size=SIZE)
    assert 500 < len(outline.exterior) <= 2000


def huge() -> bytes:
    """A PNG that says it has 30000 x 30000 pixels."""
    content = bytearray(picture(Image.new("L", (8, 8))))
    content[16:24] = (30000).to_bytes(4, "big") * 2
    import zlib

    content[29:33] = zlib.crc32(content[12:29]).to_bytes(4, "big")
    return bytes(content)


def padded() -> bytes:
    """A PNG with a note that unpacks to 100 MB."""
    note = PngImagePlugin.PngInfo()
    note.add_text("note", "x" * 100_000_000, zip=True)
    stream = io.BytesIO()
    canvas(disc("black")).save(stream, "PNG", pnginfo=note)
    return stream.getvalue()


GOOD = DISCS["dark on light"]()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "a.png: the file is empty"),
        (b"not a picture", "a.png: neither PNG nor JPEG"),
        (GOOD[:1000], r"a.png: cannot be read as a picture \("),
        (picture(canvas(disc("red")), "BMP"), "a.png: neither PNG nor JPEG"),
        (huge(), "a.png: the picture has .* pixels, at most 50 million are read"),
        (picture(Image.new("1", (8000, 7000))), "a.png: the picture has 8000 x 7000 pixels, at most 50 million"),
        (padded(), "a.png: cannot be read as a picture"),
        (b"\x89PNG\r\n\x1a\n" + b"x" * 50_000_000, "a.png: the file has 50 MB, at most 50 MB are read"),
        (picture(Image.new("RGB", (300, 200), "white")), "a.png: no body is seen"),
        (picture(Image.new("RGBA", (300, 200), (0, 0, 0, 0))), "a.png: no body is seen"),
        (picture(Image.new("RGB", (1, 1))), "a.png: the picture is too small, 1 x 1 pixels"),
        (picture(canvas(disc("black", 6))), "a.png: no body is seen"),
        (
            picture(canvas(disc("red", 120, (180, 300)), disc("red", 60, (480, 300)))),
            r"a.png: a second shape, 25 % as large as the body, lies apart from it at pixel \(480, 300\)",
        ),
        (
            picture(canvas(disc("red"), disc("white", 200), disc("red", 50))),
            r"a.png: a second shape, .* at pixel \(300, 300\)",
        ),
        (
            picture(canvas(lambda draw, fine: draw.arc([240, 240, 2160, 2160], 20, 340, "black", 6 * fine))),
            "a.png: only a thin line is seen, .* pixels wide: close the outline",
        ),
        (picture(noisy(canvas(), 90)), "a.png: "),
    ],
)
def test_refused(content: bytes, message: str) -> None:
    """Oracle: the message: one line that names the file, what is wrong, where, and what to do."""
    with pytest.raises(OutlineError, match=message) as caught:
        read_outline(content, name="a.png", size=SIZE)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300


def test_not_plain_ground() -> None:
    """Oracle: a chequered ground, which has no one color."""
    board = np.kron((np.indices((12, 12)).sum(axis=0) % 2).astype(np.uint8) * 255, np.ones((50, 50), np.uint8))
    with pytest.raises(OutlineError, match=r"a.png: the ground is not plain"):
        read_outline(picture(Image.fromarray(board)), name="a.png", size=SIZE)


def test_size() -> None:
    """Oracle: the message asks for the size, or names the bad one; what is no picture needs none."""
    with pytest.raises(OutlineError, match=r"a.png: neither PNG nor JPEG"):
        read_outline(b"noise", name="a.png")
    with pytest.raises(OutlineError, match=r"a.png: a picture has no physical size: give"):
        read_outline(GOOD, name="a.png")
    with pytest.raises(InputError, match=r"a.png: the size must be positive, not 0.0 m"):
        read_outline(GOOD, name="a.png", size=0.0)


@pytest.mark.parametrize("name", ["a.bmp", "a", "a.svg.zip", ".svg"])
def test_other_kinds_of_file(name: str) -> None:
    """Oracle: the message names what is read."""
    with pytest.raises(OutlineError, match="outlines are read from SVG, DXF, PNG and JPG files"):
        read_outline(GOOD, name=name, size=SIZE)


def test_notes_of_svg() -> None:
    """Oracle: what is in the drawing: one open line beside the body."""
    svg = b'<svg xmlns="http://www.w3.org/2000/svg"><path d="M0,0h20v20h-20z"/><path d="M5,5h4"/></svg>'
    assert read_drawing(svg, name="a.svg", size=SIZE).notes == ("left out 1 open line, the largest at (5, 5)",)


@pytest.mark.slow
def test_endings_in_capitals() -> None:
    """Oracle: the disc, whatever the case of its ending; the outline is that of the drawing."""
    for name in ("A.PNG", "b.Jpeg"):
        assert isinstance(read_outline(GOOD, name=name, size=SIZE), Outline)
    assert read_drawing(GOOD, name="a.png", size=SIZE).notes == ()


@pytest.mark.slow
def test_same_picture_same_outline() -> None:
    """Oracle: the same bytes twice give the same corners, bit for bit."""
    content = DISCS["noise, fading light, JPEG 40"]()
    first, second = (read_outline(content, name="a.jpg", size=SIZE).exterior for _ in range(2))
    assert np.array_equal(first, second)


@pytest.mark.parametrize("depth", [0.42, 0.55])
def test_a_shadow_that_is_taken_for_body_is_told(depth: float) -> None:
    """Oracle: the star without its shadow: the outline is off, and so it says; without a shadow it says nothing."""
    star = shape(STAR, (70, 120, 190))
    ground = (200, 200, 200)
    image = shadowed(canvas(star, ground=ground), canvas(shape(STAR, "white"), ground="black"), depth)
    found = read_drawing(picture(noisy(image, 3), "JPEG", quality=60), name="a.jpg", size=SIZE)
    pixel = SIZE / float(np.ptp(STAR, axis=0).max())
    assert found.outline.area > 1.1 * Polygon(STAR).area * pixel**2
    assert any("of the body has the color of the ground, only darker" in note for note in found.notes)
    plain = read_drawing(picture(noisy(canvas(star, ground=ground), 3), "JPEG", quality=60), name="a.jpg", size=SIZE)
    assert not any("darker" in note for note in plain.notes)
