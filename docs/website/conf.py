"""Settings of Sphinx for the site."""

from robokin import __version__

project = "robokin"
author = "The robokin developers"
copyright = "The robokin developers, MIT licence"
version = release = __version__
smartquotes = False  # two hyphens are an option, not a dash
language = "en-GB"
extensions = ["myst_parser"]
suppress_warnings = ["misc.highlighting_failure"]  # a console block that holds quotes is one
myst_heading_anchors = 4  # named as on GitHub
html_theme = "pydata_sphinx_theme"
html_title = "robokin"
templates_path = ["templates"]
html_static_path = ["theme"]
html_css_files = ["site.css"]
html_js_files = [("site.js", {"defer": "defer"})]
html_use_index = False
html_copy_source = False
html_show_sourcelink = False
html_sidebars = {"index": [], "gallery/*": [], "docs/api": []}
html_theme_options = {
    "logo": {"text": "robokin"},
    "navigation_with_keys": False,
    "show_nav_level": 1,
    "navigation_depth": 2,
    "collapse_navigation": True,
    "header_links_before_dropdown": 8,
    "navbar_end": ["theme-switcher"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "back_to_top_button": False,
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
