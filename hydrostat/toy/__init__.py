"""A robot in one page: a learned shape of the whole body, and an HTML file that needs neither server nor simulator."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.toy.learn_shape import learn_shape
    from hydrostat.toy.learned_shape import LearnedShape
    from hydrostat.toy.make_toy import default_samples, make_toy, sample_shapes
    from hydrostat.toy.toy_page import toy_page

__all__ = ["LearnedShape", "default_samples", "learn_shape", "make_toy", "sample_shapes", "toy_page"]

open_package(__name__)
