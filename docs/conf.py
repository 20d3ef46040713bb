"""Sphinx builds the documentation from the Markdown pages of this folder and the docstrings: `make docs`."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "_ext"), str(HERE.parent)]

import drakearm  # noqa: E402
import drakearm.systems  # noqa: E402

project = "drakearm"
author = project_copyright = "The drakearm developers"
version = release = drakearm.__version__
html_title = f"drakearm {version}"

extensions = ["myst_nb", "sphinx.ext.autodoc", "class_docs", "markdown_docstrings", "pydrake_system"]
exclude_patterns = ["_ext", "_build"]

# Pages: links to headings work as on GitHub.
myst_heading_anchors = 4
highlight_language = "none"

# Where this site shows files that lie elsewhere in the repository, relative to a page of this folder.
_SHOWN = {
    "../README.md": "index.md",
    "../CHANGELOG.md": "changelog.md",
    "../CONTRIBUTING.md": "contributing.md",
    "../SECURITY.md": "security.md",
    "../drakearm/model/rat_hindlimb/CREDITS.md": "credits.md",
    "../drakearm/model/arm14/CREDITS.md": "credits.md",
    "../drakearm/model/arm26/CREDITS.md": "credits.md",
    "../drakearm/reproduction/hug_mp/CREDITS.md": "credits.md",
}


def _link_to_pages(app, page, source):
    for file, shown in _SHOWN.items():
        source[0] = source[0].replace(f"]({file}", f"]({shown}")


def setup(app):
    app.connect("source-read", _link_to_pages)


# Tutorials run when they have changed. An error in one is an error of the build.
nb_execution_mode = "cache"
nb_execution_in_temp = True
nb_execution_timeout = 300
nb_execution_raise_on_error = True
nb_merge_streams = True
nb_output_stderr = "remove"

# Docstrings: a name in backticks is a link where it names something, else code.
default_role = "py:obj"
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_default_options = {"members": True, "exclude-members": "HillMuscles_"}
python_maximum_signature_line_length = 88
python_display_short_literal_types = True
add_module_names = False

# The theme has its fonts and scripts with it: the site needs no other one.
html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_theme_options = {"top_of_page_buttons": []}

# Systems that exist for several scalars have the name of the template, not of its instance.
for _name in drakearm.systems.__all__:
    _system = getattr(drakearm.systems, _name)
    if isinstance(_system, type):
        _system.__name__ = _system.__qualname__ = _name
