"""Settings of the documentation site, built by `make docs` into build/docs.

Pages of commands and of the Python API are written from the code before each build, into docs/generated.
"""

import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path[:0] = [str(ROOT), str(HERE)]

from site_reference import GENERATED, on_site, write_reference, write_toy  # noqa: E402

from hydrostat import __version__, simulation  # noqa: E402

if find_spec("torch") is None:  # the gallery looks up what its examples import
    vars(simulation)["solve_torch"] = None

project = "hydrostat"
author = "hydrostat contributors"
copyright = author
release = version = __version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_design",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
]
root_doc = "index"
exclude_patterns = ["bodies"]
suppress_warnings = ["misc.highlighting_failure", "config.cache"]
default_role = "literal"
smartquotes = False

myst_enable_extensions = ["colon_fence", "dollarmath", "fieldlist"]
myst_heading_anchors = 4

autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
autodoc_mock_imports = ["torch", "stable_baselines3", "sb3_contrib", "gymnasium", "ray", "cv2", "mediapipe"]
napoleon_use_ivar = True

html_theme = "furo"
html_title = f"hydrostat {__version__}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False


def scrape_figure(_block: Any, variables: dict[str, Any], settings: dict[str, Any]) -> str:
    """Save the figure that a block of an example binds to the name `figure`."""
    from sphinx_gallery.scrapers import figure_rst

    figure = variables["example_globals"].get("figure")
    if figure is None or getattr(figure, "is_saved", False):
        return ""
    path = next(variables["image_path_iterator"])
    figure.savefig(path, dpi=110)
    figure.is_saved = True
    return figure_rst([path], settings["src_dir"])


sphinx_gallery_conf = {
    "examples_dirs": [str(ROOT / "examples" / "python")],
    "gallery_dirs": ["examples"],
    "filename_pattern": r"/\d\d_" if find_spec("torch") else r"/\d\d_(?!learn|torch)",  # those are shown, not run
    "within_subsection_order": "FileNameSortKey",
    "image_scrapers": (scrape_figure,),
    "download_all_examples": False,
    "show_signature": False,
    "min_reported_time": 0,
    "remove_config_comments": True,
    "abort_on_example_error": True,
}


def read_source(_app: Any, page: str, source: list[str]) -> None:
    """Lead links of a page to pages of the site, and list the decisions below theirs."""
    if page.startswith(("generated/", "examples/")):
        return
    source[0] = on_site(source[0], HERE / page, HERE / page)
    if page == "decisions/README":
        source[0] += "\n```{toctree}\n:hidden:\n:glob:\n\n0*\n```\n"


def setup(app: Any) -> None:
    """Write the reference pages before Sphinx reads its sources, and the toy of the first page."""
    app.connect("builder-inited", lambda _app: write_reference(GENERATED))
    app.add_config_value("toy_options", "", "")
    app.connect("builder-inited", lambda site: write_toy(Path(site.outdir), site.config.toy_options))
    app.connect("source-read", read_source)
