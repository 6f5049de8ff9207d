"""Export of robots to other simulators: MuJoCo (MJCF) and USD."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.export.fit_mjcf import fit_mjcf
    from hydrostat.export.measure_mjcf import measure_mjcf
    from hydrostat.export.mjcf import find_omissions, mjcf_text
    from hydrostat.export.mjcf_tuning import MjcfTuning
    from hydrostat.export.usd import usd_text

__all__ = ["MjcfTuning", "find_omissions", "fit_mjcf", "measure_mjcf", "mjcf_text", "usd_text"]

open_package(__name__)
