"""Configuration of the documentation site, which `make docs` builds.

The theme is Furo: it is maintained, has a dark mode, and loads neither fonts nor scripts from
another site, so the site works without a network and under the server's security headers.
"""

import runpy
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))
VERSION = runpy.run_path(str(HERE.parent / "engine/microcosmos/version.py"))["VERSION"]

project = "Microcosmos"
author = "The Microcosmos authors"
project_copyright = author
version = release = VERSION

extensions = ["myst_parser", "reference", "endpoints", "inline_scripts"]
exclude_patterns = ["_*"]
nitpicky = True
nitpick_ignore_regex = [(r"py:.*", r".*")]  # Annotations name types that have no page here.
suppress_warnings = ["ref.python"]  # Packages may export the same name.
python_maximum_signature_line_length = 88

myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 4

templates_path = ["_templates"]
html_theme = "furo"
html_title = f"Microcosmos {VERSION}"
html_static_path = ["_static"]
html_favicon = "../web/public/favicon.svg"
html_domain_indices = False  # Its page has an inline script; the reference lists the modules.
html_copy_source = False
html_show_sourcelink = False
