"""A soft robot by LeRobot. Oracles: LeRobot's own factories and teleoperation loop, and python-osc's own client."""

import threading
import time

import pytest

pytest.importorskip("lerobot")

from lerobot.robots import make_robot_from_config
from lerobot.teleoperators import make_teleoperator_from_config
from lerobot_robot_hydrostat import HydrostatRobotConfig, HydrostatTeleopConfig

from hydrostat.errors import HydrostatError
from hydrostat.robot import gallery_folder

STARFISH = str(gallery_folder("starfish"))


@pytest.mark.parametrize("port", ["", "emulated"])
def test_actions_turn_winches_within_limits(port: str, tmp_path) -> None:
    robot = make_robot_from_config(HydrostatRobotConfig(robot=STARFISH, port=port, calibration_dir=tmp_path))
    assert robot.action_features == {"right.pos": float, "left.pos": float, "feet.pos": float}
    with pytest.raises(HydrostatError, match="not connected"):
        robot.get_observation()
    with robot:
        assert robot.is_connected
        assert set(robot.get_observation()) == set(robot.observation_features)
        for _ in range(60):
            sent = robot.send_action({"left.pos": 6.0, "right.pos": 1e4})
            time.sleep(0.02)
        assert sent["left.pos"] == 6.0
        assert sent["right.pos"] < 1e3
        told = robot.get_observation()
        assert told["left.pos"] == pytest.approx(6.0, abs=0.4)
        time.sleep(0.7)  # nobody asks: they stand
        before = robot.get_observation()["right.pos"]
        time.sleep(0.2)
        assert robot.get_observation()["right.pos"] == pytest.approx(before, abs=0.4)
    assert not robot.is_connected


def test_the_loop_of_lerobot_drives_it(tmp_path) -> None:
    client = pytest.importorskip("pythonosc.udp_client")
    from lerobot.processor import make_default_processors
    from lerobot.scripts.lerobot_teleoperate import teleop_loop

    robot = make_robot_from_config(HydrostatRobotConfig(robot=STARFISH, calibration_dir=tmp_path))
    config = HydrostatTeleopConfig(robot=STARFISH, source="osc:9477", calibration_dir=tmp_path)
    teleop = make_teleoperator_from_config(config)
    assert teleop.action_features == robot.action_features
    sender = client.SimpleUDPClient("127.0.0.1", 9477)
    with teleop, robot:
        threading.Timer(0.3, sender.send_message, ("/winch/left", 7.0)).start()
        teleop_loop(teleop, robot, 30, *make_default_processors(), duration=1.5)
        assert robot.get_observation()["left.pos"] == pytest.approx(7.0, abs=0.1)
        sender.send_message("/end", [])
        time.sleep(0.1)
        with pytest.raises(HydrostatError, match="the person has ended"):
            teleop.get_action()
    sender._sock.close()
