import pytest

from hydrostat.fabrication.patterns.lettering import CAP_HEIGHT, GLYPHS, UNKNOWN, Lettering


def test_every_glyph_fits_its_box_and_is_its_own():
    """Oracle: the grid of the font, 4 by 6; no two characters are drawn alike."""
    for strokes in (*GLYPHS.values(), UNKNOWN):
        for stroke in strokes.split():
            assert len(stroke) >= 4
            assert len(stroke) % 2 == 0
            assert max(map(int, stroke[::2])) <= 4
            assert max(map(int, stroke[1::2])) <= CAP_HEIGHT
    assert len(set(GLYPHS.values())) == len(GLYPHS)


@pytest.mark.parametrize(("text", "same"), [("sam", "SAM"), ("Zoë", "ZOE"), ("a\n b", "A B")])
def test_text_is_made_plain(text, same):
    """Oracle: the plain text drawn."""
    assert Lettering(text, 4).lines((0, 0)) == Lettering(same, 4).lines((0, 0))


def test_an_unknown_character_is_a_box():
    """Oracle: one closed stroke of the font's full size."""
    (box,) = Lettering("海", 6).lines((2, 3))
    assert box.points == ((0, 0), (0, 6), (4, 6), (4, 0), (0, 0))


def test_text_is_centered_and_as_wide_as_it_says():
    """Oracle: the bounds of its strokes."""
    text = Lettering("HI 5!", 9)
    points = [point for line in text.lines((10, 20)) for point in line.points]
    left, right = min(x for x, _ in points), max(x for x, _ in points)
    assert right - left == pytest.approx(text.width)
    assert (left + right) / 2 == pytest.approx(10)
    assert max(y for _, y in points) - min(y for _, y in points) == pytest.approx(9)


def test_nothing_to_write_is_nothing_drawn():
    """Oracle: no strokes."""
    assert Lettering("  ", 4).lines((0, 0)) == ()
    assert Lettering("", 4).width == 0
