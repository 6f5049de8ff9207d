"""Ten thousand injected faults, and faults of ours that the campaign must catch. Oracle: the emulated servos."""

from collections.abc import Callable

import numpy as np
import pytest
from fault_campaign import HARD, Campaign
from several_boards import BoardsCampaign

from hydrostat.control import bus_link
from hydrostat.control.bus_link import BusLink
from hydrostat.control.dynamixel_bus import DynamixelBus
from hydrostat.control.dynamixel_packets import PacketReader
from hydrostat.control.feetech_bus import FeetechBus
from hydrostat.control.guard import TensionGuard

pytestmark = pytest.mark.usefixtures("unchecked")


@pytest.mark.slow
def test_ten_thousand_faults_leave_motors_within_limits_standing_in_time_and_told() -> None:
    campaign = Campaign(np.random.default_rng(20), seconds=2.0, share=0.25)
    while campaign.injected < 10_000:
        campaign.run()
    assert not campaign.wrong
    assert min(campaign.count[kind] for kind in HARD) > 3


@pytest.mark.slow
@pytest.mark.parametrize("kind", [Campaign, BoardsCampaign])
def test_seeds_that_no_test_knows(kind: type[Campaign]) -> None:
    """Two hundred faults of another seed each time, which a failure prints."""
    seed = int(np.random.SeedSequence().generate_state(1)[0])
    campaign = kind(np.random.default_rng(seed), seconds=2.0, share=0.25)
    while campaign.injected < 200:
        campaign.run()
    assert not campaign.wrong, f"seed {seed}"


def broken(monkeypatch: pytest.MonkeyPatch, bug: str) -> None:
    if bug == "goals far ahead":
        monkeypatch.setattr(bus_link, "MAX_LEAD_TIME", 5.0)
    elif bug == "goals too far ahead":
        monkeypatch.setattr(bus_link, "MAX_LEAD_TIME", 0.45)
    elif bug == "bounds of current that bound nothing":
        for kind in (DynamixelBus, FeetechBus):
            arm: Callable = kind.arm
            monkeypatch.setattr(kind, "arm", lambda self, currents, arm=arm: arm(self, 1000 * currents))
    elif bug == "no guard of tensions":
        monkeypatch.setattr(TensionGuard, "fault", lambda *_: "")
    elif bug == "no limits":
        initialize: Callable = BusLink.__init__

        def without_limits(self: BusLink, *args: object, **more: object) -> None:
            initialize(self, *args, **more)
            self._low, self._high = self._low - 1.0, self._high + 1.0

        monkeypatch.setattr(BusLink, "__init__", without_limits)
    else:
        monkeypatch.setattr(BusLink, "_judge", lambda self, now, armed: None)


@pytest.mark.parametrize(
    ("bug", "caught"),
    [
        ("goals far ahead", "still turning"),
        ("goals too far ahead", "after the last command, host sleeps"),
        ("bounds of current that bound nothing", "pulls too hard"),
        ("no guard of tensions", "cut: told as ''"),
        ("no guard of tensions", "jammed: told as"),
        ("no limits", "beyond"),
        ("a link that judges nothing", "told as"),
    ],
)
def test_a_bug_is_caught(bug: str, caught: str, monkeypatch: pytest.MonkeyPatch) -> None:
    broken(monkeypatch, bug)
    campaign = Campaign(np.random.default_rng(22), seconds=0.4)
    for _ in range(80):
        campaign.run()
        if any(caught in word for word in campaign.wrong):
            return
    pytest.fail(f"not caught: {campaign.wrong}")


def test_damaged_bytes_are_counted() -> None:
    reader = PacketReader()
    assert not list(reader.feed(b"\xff\xff\xfd\x00\x01\x04\x00\x55\x00\x00\x00" + bytes(20)))
    assert reader.damaged == 1
