"""Configuration of the site, for Sphinx: `sphinx-build -W -n docs build/site/html`.

Pages are Markdown (MyST). Blocks that are filled at the build are described in extensions/pages.py.
"""

import os
import sys
from importlib.util import find_spec
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "extensions"))

project = "houle"
author = "the houle developers"
copyright = "the houle developers, Apache License 2.0"
html_title = "houle"

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx_design", "sphinx_copybutton", "site_pages"]
exclude_patterns = ["extensions"]
default_role = "code"
nitpicky = True
nitpick_ignore_regex = [
    ("py:.*", r"(?!houle\.((analysis|design)\.)?\w+$).*")
]  # types of other packages, and of ours inside
suppress_warnings = ["myst.header"]  # the decisions begin with their number

myst_enable_extensions = ["dollarmath", "deflist", "attrs_inline"]
myst_heading_anchors = 4
myst_dmath_double_inline = True
highlight_language = "none"  # of blocks that name no language
smartquotes = False  # quotation marks in pages are those of case files

os.environ.pop("MPLBACKEND", None)  # notebooks show their figures
nb_execution_mode = "cache" if "HOULE_SITE_KEEP" in os.environ else "force"  # kept: for work on the texts alone
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 90
add_module_names = False

html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sphinx = False
copybutton_prompt_text = r"[$>] "
copybutton_prompt_is_regexp = True
linkcheck_anchors = False
linkcheck_exclude_documents = ["changelog"]

if find_spec("sphinx-mathjax-offline"):  # formulas without a network: site_pages copies them
    mathjax_path = "mathjax/tex-chtml.js"
