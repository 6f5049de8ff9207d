"""A robot in a link. Oracles: the robot that was packed; OpenCV reads the code."""

import json
import zlib
from base64 import urlsafe_b64encode
from dataclasses import replace

import cv2
import numpy as np
import pytest
import segno

from hydrostat.errors import InputError
from hydrostat.robot import gallery_folder
from hydrostat.studio.face.share import MAX_CODE_LETTERS
from hydrostat.studio.robot_link import LINK_MARK, MAX_BYTES, pack_robot
from hydrostat.studio.session import Session


def open_starfish() -> Session:
    session = Session()
    session.starter.open_gallery(gallery_folder("starfish"))
    return session


def link_of(text: bytes) -> str:
    deflate = zlib.compressobj(9, wbits=-15)
    return LINK_MARK + urlsafe_b64encode(deflate.compress(text) + deflate.flush()).decode()


def test_a_link_holds_the_robot_and_fits_a_code() -> None:
    mine = open_starfish()
    name = "Seestern é"
    mine.document.change("rename", robot=replace(mine.document.robot, name=name))
    link = "http://192.168.1.20:38211/?token=Zk3vQ0n0_x-AbCdEfGhIjK" + mine.exporter.robot_link()
    assert len(link) <= MAX_CODE_LETTERS
    matrix = np.array([list(row) for row in segno.make(link, error="l").matrix_iter(scale=6, border=4)])
    assert cv2.QRCodeDetectorAruco().detectAndDecode((255 * (1 - matrix)).astype(np.uint8))[0] == link
    other = Session()
    other.starter.open_link(link)
    assert other.document.robot == mine.document.robot


def test_a_body_in_space_fits_no_link() -> None:
    session = Session()
    session.starter.open_gallery(gallery_folder("tongue"))
    with pytest.raises(InputError, match=r"flat robots only\. Send the \.zip"):
        session.exporter.robot_link()
    with pytest.raises(InputError, match="Press Edit outline"):
        pack_robot({"robot.toml": b"", "photo.png": b"\x89PNG"})
    with pytest.raises(InputError, match=r"maximum 30000\)\. Send the \.zip"):
        pack_robot({"robot.toml": np.random.default_rng(0).bytes(40_000).hex().encode()})


@pytest.mark.parametrize(
    ("link", "words"),
    [
        ("http://127.0.0.1/", "no robot in this link"),
        (LINK_MARK + "A" * 30_001, "no robot in this link"),
        (LINK_MARK + "****", "incomplete or holds no robot"),
        (link_of(b"x" * (MAX_BYTES + 1)), "incomplete or holds no robot"),
        (link_of(b"[1]"), "incomplete or holds no robot"),
        (link_of(b'{"robot.toml": 1}'), "incomplete or holds no robot"),
        (link_of(b"[" * 100_000), "incomplete or holds no robot"),
        (link_of(json.dumps({"a" * 70_000: ""}).encode()), "incomplete or holds no robot"),
        (link_of(json.dumps({"../robot.toml": ""}).encode()), "outside the robot's folder"),
        (link_of(json.dumps({"/etc/robot.toml": ""}).encode()), "outside the robot's folder"),
        (link_of(json.dumps({"readme": ""}).encode()), "no robot.toml found"),
        (link_of(json.dumps({"robot.toml": "name = 1", "\ud800": ""}).encode()), "incomplete or holds no robot"),
    ],
)
def test_a_forged_link_is_refused_in_one_line(link: str, words: str) -> None:
    session = open_starfish()
    with pytest.raises(InputError, match=words) as refused:
        session.starter.open_link(link)
    assert "\n" not in str(refused.value).strip()
    assert session.document.robot.name == "starfish"


def test_a_cut_link_is_refused() -> None:
    """Each cut in steps of 97 letters; none opens a robot."""
    session = open_starfish()
    link = session.exporter.robot_link()
    for end in range(len(LINK_MARK) + 1, len(link), 97):
        with pytest.raises(InputError):
            Session().starter.open_link(link[:end])
