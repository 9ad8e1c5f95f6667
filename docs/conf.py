"""How `scripts/docs` makes the site of these pages, of the docstrings and of the gallery."""

from __future__ import annotations

from importlib.metadata import version as version_of

project, author = "rthm", "the authors of rthm"
release = version = version_of("rthm_core")
html_title = f"rthm {version}"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["gallery/**/*.ipynb", "gallery/**/*.py"]
suppress_warnings = ["toc.not_included"]  # decisions are listed by their own page

# Pages are read on the project's host as well, so their links are those of files.
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 3

# The docstrings are numpydoc; types stand in them, and need not be told twice.
napoleon_google_docstring = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "show-inheritance": True}
default_role = "code"

sphinx_gallery_conf = {
    "examples_dirs": "../examples/gallery",
    "gallery_dirs": "gallery",
    "filename_pattern": r"/\d",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "capture_repr": (),
    "download_all_examples": False,
    "show_memory": False,
    "write_computation_times": False,
    "show_signature": False,
}

# Nothing on a page comes from elsewhere: no fonts, no scripts.
html_theme = "furo"
html_show_copyright = False
html_theme_options = {"navigation_with_keys": True}
