"""Sphinx's settings for the documentation of carat; tools/build_docs.sh runs it."""

import os
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

from docutils import nodes
from docutils.parsers.rst import Directive
from docutils.statemachine import StringList

import carat

ROOT = Path(__file__).resolve().parent.parent.parent

project = "carat"
author = "the carat authors"
copyright = author  # noqa: A001  no year: builds do not depend on the date
version = release = carat.__version__

extensions = [
    "breathe",
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx_copybutton",
]
root_doc = "index"
exclude_patterns = ["site/**"]
default_role = "code"
highlight_language = "text"
nitpicky = False

html_theme = "furo"
html_title = "carat"
html_static_path = ["static"]
html_css_files = ["carat.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_last_updated_fmt = None
html_theme_options = {"navigation_with_keys": True}

myst_enable_extensions = ["colon_fence", "html_image"]
myst_heading_anchors = 4
myst_footnote_transition = False

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings say the types
numpydoc_show_class_members = False  # autodoc lists them

breathe_projects = {"carat": os.environ["CARAT_DOXYGEN_XML"]}
breathe_default_project = "carat"
breathe_default_members = ("members",)
breathe_show_include = False

copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True


class Script(Directive):
    """A script of examples/, and below what it prints when it is run."""

    required_arguments = 1

    def run(self):
        path = ROOT / self.arguments[0]
        self.state.document.settings.env.note_dependency(str(path))
        done = subprocess.run([sys.executable, str(path)], capture_output=True, text=True,
                              check=False)
        if done.returncode:
            raise self.error(f"{path.name} ends with {done.returncode}: {done.stderr}")
        # Marks of cells, and what is of the notebook alone, are for tools/make_notebooks.py.
        text = re.sub(r"^# %% \[notebook\]\n(?:#.*\n)+\n*", "", path.read_text(), flags=re.M)
        text = re.sub(r"^# %%.*\n", "", text, flags=re.M)
        source = nodes.literal_block(text, text, language="python", classes=["script"])
        output = nodes.literal_block(done.stdout, done.stdout, language="text")
        output["classes"].append("output")
        return [source, output]


class Header(Directive):
    """Everything that a public C++ header declares, in its order."""

    required_arguments = 1

    def run(self):
        name = self.arguments[0]
        lines = [line for _, line in sorted(declarations(name))]
        if not lines:
            raise self.error(f"{name} declares nothing; is it among docs/site/Doxyfile's INPUT?")
        title = nodes.paragraph("", "", nodes.literal(text=f"#include <{name}>"))
        made = nodes.container()
        content = StringList([part for line in lines for part in (*line.split("\n"), "")], name)
        self.state.nested_parse(content, self.content_offset, made)
        return [title, *made.children]


def declarations(header):
    """(line, breathe's directive) of what a header declares outside of classes."""
    folder = Path(os.environ["CARAT_DOXYGEN_XML"])
    for path in folder.glob("*.xml"):
        compound = ElementTree.parse(path).getroot().find("compounddef")
        if compound is None:
            continue
        kind, name = compound.get("kind"), compound.findtext("compoundname")
        if kind in ("class", "struct") and name.count("::") == 1:
            location = compound.find("location")
            if location.get("file") == header:
                text = f".. doxygen{kind}:: {name}\n   :members:\n   :undoc-members:"
                yield int(location.get("line")), text
        elif kind == "namespace":
            for member in compound.iter("memberdef"):
                location = member.find("location")
                if location.get("file") == header:
                    yield int(location.get("line")), directive(name, member)


def directive(namespace, member):
    kind, name = member.get("kind"), f"{namespace}::{member.findtext('name')}"
    result = "".join(member.find("type").itertext()) if member.find("type") is not None else ""
    if kind == "function" and "(" in result:  # breathe cannot tell such a result from the arguments
        description = member.find("detaileddescription/para")
        said = "".join(description.itertext() if description is not None else [])
        said = " ".join(said.split())
        arguments = " ".join(member.findtext("argsstring").split())
        return f".. cpp:function:: {result} {name}{arguments}\n\n   {said}"
    if kind == "function":
        types = ("".join(parameter.find("type").itertext()) for parameter in member.iter("param")
                 if parameter.find("declname") is not None)
        name += f"({', '.join(types)})"
    return f".. doxygen{kind}:: {name}"


# Pages that lie beside docs/, taken in under other names.
OUTSIDE = {"api/architecture": "ARCHITECTURE.md", "api/changelog": "CHANGELOG.md",
           "api/contributing": "CONTRIBUTING.md"}


def adapt_links(app, docname, source):
    """Takes in the pages beside docs/, and makes links between them and those in docs/ hold."""
    text = source[0]
    if docname in OUTSIDE:
        text = (ROOT / OUTSIDE[docname]).read_text(encoding="utf-8")
        text = text.replace("](docs/", "](../")
    for page, file in OUTSIDE.items():
        text = re.sub(rf"\]\((?:\.\./)*{re.escape(file)}", f"](/{page}.md", text)
    source[0] = text


def check_all_is_documented(app, error):
    """Whatever carat exports has an entry, and so has every header of carat/carat.h."""
    if error is None and app.builder.name == "html":
        headers = re.findall(r'#include "([^"]+)"', (ROOT / "src/carat/carat.h").read_text())
        page = (ROOT / "docs/api/cpp.rst").read_text()
        missing = [header for header in headers if f".. header:: {header}\n" not in page]
        if missing:
            raise RuntimeError(f"docs/api/cpp.rst lacks {', '.join(missing)}")
        objects = app.env.get_domain("py").objects
        missing = [name for name in carat.__all__ if f"carat.{name}" not in objects]
        if missing:
            raise RuntimeError(f"docs/api/python.rst lacks {', '.join(missing)}")


def setup(app):
    app.add_directive("script", Script)
    app.add_directive("header", Header)
    app.connect("source-read", adapt_links)
    app.connect("build-finished", check_all_is_documented)
    return {"parallel_read_safe": True}
