"""The site: ``make docs`` writes it to ``build/site``.

Pages are the Markdown files in ``docs``. Added to them are

* the README of the repository, on the home page, and files of the repository that pages link to;
* a page for each notebook in ``docs``, with its output;
* a gallery on the page of figures: each figure with its caption, the command that makes it, and a
  picture, drawn from the tables in ``docs/results``, or of the demo, from ``docs/images``;
* the API reference, one page for each package of the library.

A broken link, a docstring that cannot be parsed, or a public name without a docstring fails the
build. ``--check`` looks for these alone: it draws and writes nothing.
"""

import argparse
import ast
import base64
import json
import posixpath
import re
import shutil
import sys
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml
from matplotlib.figure import Figure
from snakemake.utils import update_config
from sphinx.cmd.build import main as sphinx

from burstcast.base.declared import called
from burstcast.base.files.tables import read_table
from burstcast.figures.parts.style import render
from burstcast.figures.registry import figure_of
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.loading import load
from burstcast_workflow.figures.registry import FIGURES, cases_of, files_of, settings_of
from burstcast_workflow.tables.declarations import SECTIONS
from burstcast_workflow.tables.registry import OPTIONAL, table_of
from burstcast_workflow.tracking.code import make_importable

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
LIBRARY = ROOT / "src" / "burstcast"
NAVIGATION = {
    "Run and change": ["installing", "settings", "figures", "tables", "errors", "cluster"],
    "Your data, system, model": [
        *("notebook", "event_forecast", "own_data", "lorenz96", "what_if", "campaign"),
        *("tutorial_data", "data_recipes", "real_records", "tutorial", "sensors", "aware"),
        *("return_times", "return_levels", "controllers"),
    ],
    "Results and method": [
        *("results", "related_work", "references", "method", "performance"),
    ],
    "Campaigns": [
        *(
            "results/paper",
            "results/beyond_the_paper",
            "results/other_libraries",
            "results/wrong_model",
            "results/readout",
        ),
        *("results/authors", "results/noise_sweep", "results/aware", "results/learnt_precursor"),
        *("results/kolmogorov", "results/smoothing", "results/hidden_modes"),
        "results/which_method",
    ],
    "How it is built": [
        *("architecture", "rules", "extending", "selective_rebuilds", "decisions"),
        "repository/CONTRIBUTING",
    ],
}
# Campaigns that figures are taken from, in this order: the paper's, then presets and examples.
PRESETS = ("", "beyond_the_paper", "partial_observation", "aware", "kolmogorov", "quick")
PRESETS += ("return_times",)
_LINK = re.compile(r"(?P<before>\]\(|^\[[^\]]+\]: )(?P<path>[^)#\s:]+)(?P<after>[)#\s])", re.M)
_FENCE = re.compile(r"^ *```.*?^ *```$", re.M | re.S)


# -- links -----------------------------------------------------------------------------------------


def _in_site(path: Path) -> str:
    """Address in the site of a file of the repository."""
    if path == DOCS / "README.md":
        return "index.md"
    if path.is_relative_to(DOCS):
        page = path.with_suffix(".md") if path.suffix == ".ipynb" else path
        return page.relative_to(DOCS).as_posix()
    return f"repository/{path.relative_to(ROOT).as_posix()}"


def _relinked(text: str, source: Path, page: str) -> str:
    """Text of a file of the repository with links that hold on its page of the site."""

    def link(match: re.Match[str]) -> str:
        target = (source.parent / match["path"]).resolve()
        if not target.is_file():
            return match[0]  # Sphinx reports it
        relative = posixpath.relpath(_in_site(target), posixpath.dirname(page) or ".")
        return f"{match['before']}{relative}{match['after']}"

    return _LINK.sub(link, text)


def _pages_of_docs() -> list[Path]:
    """Pages in docs, with those of the results of campaigns."""
    return [*DOCS.glob("*.md"), *DOCS.glob("results/*.md")]


def _linked_files() -> set[Path]:
    """Files outside of docs that pages link to, directly or through one another."""
    files = {ROOT / "CONTRIBUTING.md"}
    waiting = [*_pages_of_docs(), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
    seen = set(waiting)
    while waiting:
        page = waiting.pop()
        for link in _LINK.finditer(_FENCE.sub("", page.read_text(encoding="utf-8"))):
            target = (page.parent / link["path"]).resolve()
            if target.is_file() and not target.is_relative_to(DOCS):
                files.add(target)
                if target.suffix == ".md" and target not in seen:
                    seen.add(target)
                    waiting.append(target)
    return files - {ROOT / "README.md"}


# -- the API reference -----------------------------------------------------------------------------


def _modules() -> dict[str, dict[str, ast.Module]]:
    """Public modules of the library, parsed, by the package that has a page."""
    pages: dict[str, dict[str, ast.Module]] = {}
    for path in sorted(LIBRARY.rglob("*.py"), key=lambda path: path.with_suffix("").parts):
        parts = path.relative_to(LIBRARY.parent).with_suffix("").parts
        parts = parts[:-1] if parts[-1] == "__init__" else parts
        if any(part.startswith("_") for part in parts):
            continue
        package = parts[1] if len(parts) > 1 and (LIBRARY / parts[1]).is_dir() else ""
        page = pages.setdefault(".".join(filter(None, ("burstcast", package))), {})
        page[".".join(parts)] = ast.parse(path.read_text(encoding="utf-8"))
    return {name: dict(sorted(page.items())) for name, page in sorted(pages.items())}


def _undocumented(name: str, node: ast.Module | ast.ClassDef | ast.FunctionDef) -> Iterator[str]:
    """Public modules, classes, functions and methods without a docstring; signatures need none."""
    signature = any(
        "overload" in ast.unparse(decorator) for decorator in getattr(node, "decorator_list", [])
    )
    if ast.get_docstring(node) is None and not signature:
        yield name
    if not isinstance(node, ast.FunctionDef):
        for child in node.body:
            if isinstance(child, ast.ClassDef | ast.FunctionDef) and child.name[0] != "_":
                yield from _undocumented(f"{name}.{child.name}", child)


def api_pages() -> dict[str, str]:
    """Text of each page of the API reference.

    Raises
    ------
    SystemExit
        If a public name has no docstring.
    """
    pages, rows, missing = {}, [], []
    for package, modules in _modules().items():
        lines = [f"# {package}", ""]
        for module, tree in modules.items():
            missing += _undocumented(module, tree)
            heading = [f"## {module}", ""] if module != package else []
            lines += [*heading, "```{eval-rst}", f".. automodule:: {module}", "```", ""]
        pages[f"api/{package}.md"] = "\n".join(lines)
        first = (ast.get_docstring(modules[package]) or "").partition("\n")[0]
        rows.append(f"| [{package}]({package}.md) | {first} |")
    if missing:
        raise SystemExit(f"public names without a docstring: {', '.join(missing)}")
    start = (DOCS / "site" / "api.md").read_text(encoding="utf-8")
    listed = _toctree("", [name.removeprefix("api/").removesuffix(".md") for name in pages])
    table = ["| package | contents |", "| --- | --- |", *rows]
    return {"api/index.md": "\n".join([start, *table, "", listed]), **pages}


def _toctree(title: str, names: list[str]) -> str:
    heading = [f":caption: {title}"] if title else []
    return "\n".join(["```{toctree}", ":hidden:", *heading, "", *names, "```", ""])


# -- the gallery -----------------------------------------------------------------------------------


def _kept(place: str | list[str], preset: str) -> Any:
    """Rows of a case, or of each of several, of a kept table of a campaign.

    None if it is not kept, or lacks a column that the table has by now.
    """
    if not isinstance(place, str):
        tables = [_kept(part, preset) for part in place]
        return tables if tables and all(table is not None for table in tables) else None
    case, _, name = place.partition("/tables/")
    path = DOCS / "results" / (preset or "paper") / name
    if not name or not path.exists():
        return None
    table, declared = read_table(path), table_of(path.stem)
    needed = {
        column for column in (*declared.keys, *declared.columns) if not column.endswith(OPTIONAL)
    }
    if not needed <= {*table.columns}:
        return None
    return table[table["case"] == case].reset_index(drop=True)


def pictures(wanted: Collection[str] = FIGURES) -> dict[str, tuple[str, bytes]]:
    """Figures that can be drawn from kept tables: the preset whose they are, and the PNG."""
    images: dict[str, tuple[str, bytes]] = {}
    for preset in PRESETS:
        campaign = _campaign(preset)
        for name in wanted:
            figure = FIGURES[name]
            cases = cases_of(campaign, figure)
            if not cases or name in images:
                continue
            places = files_of(campaign, figure, cases[0])
            inputs = {key: _kept(place, preset) for key, place in places.items()}
            if not inputs or any(content is None for content in inputs.values()):
                continue
            values = settings_of(campaign, figure, cases[0])
            images[name] = preset, render(_drawn(name, values, inputs), "png")
    return images


def _drawn(name: str, values: Mapping[str, Any], inputs: Mapping[str, Any]) -> Figure:
    """Draw a figure of values of its settings by path, and of its inputs by name."""
    figure, published = figure_of(name), {}
    if figure.published:
        published["published"] = read_table(ROOT / "resources" / "published_percentiles.csv")
    return called(figure.draw, values.__getitem__, lambda name, _: inputs[name], **published)


def _campaign(preset: str) -> Campaign:
    """The campaign of a preset; without a name, the paper's."""
    config = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
    if preset:
        overlay = ROOT / _overlay(preset)
        make_importable([str(overlay.parent)])  # a system may lie beside its campaign
        update_config(config, yaml.safe_load(overlay.read_text(encoding="utf-8")))
    return Campaign(load(config))


def _overlay(preset: str) -> str:
    """Path of what a campaign lays over the paper's: an example, or a preset."""
    example = f"examples/{preset}/campaign.yaml"
    return example if (ROOT / example).exists() else f"workflow/presets/{preset}.yaml"


def _is_kept(name: str) -> bool:
    return (DOCS / "images" / f"{name}.png").exists()


def gallery(drawn: Mapping[str, str]) -> str:
    """Each figure with its caption, picture and command, by the sections of the report.

    ``drawn`` has the presets of figures that were drawn from kept tables; kept pictures are of the
    demo if that makes the figure.
    """
    campaigns = {preset: _campaign(preset) for preset in PRESETS}
    lines, section = ["\n## Gallery\n"], ""
    for name in FIGURES:
        if section != (section := FIGURES[name].section):
            lines.append(f"### {SECTIONS[section].partition(' ')[2]}\n")
        lines += [f"#### {name}\n", f"{FIGURES[name].caption.replace('``', '`')}\n"]
        if name in drawn or _is_kept(name):
            lines.append(f"![{name}](images/{name}.png)\n")
        makers = [
            candidate for candidate in PRESETS if cases_of(campaigns[candidate], FIGURES[name])
        ]
        of_demo = _is_kept(name) and "quick" in makers
        preset = drawn.get(name, "quick" if of_demo else makers[0])
        option = f" --configfile {_overlay(preset)}" if preset else ""
        results = campaigns[preset].config.results
        target = f"{results}/figures/{name}.png"
        lines.append(f"```sh\n.venv/bin/snakemake{option} {target}\n```\n")
    return "\n".join(lines)


# -- notebooks -------------------------------------------------------------------------------------


def _notebooks() -> dict[str, dict[str, Any]]:
    return {
        path.stem: json.loads(path.read_text(encoding="utf-8"))
        for path in sorted(DOCS.glob("*.ipynb"))
    }


def _outputs(cell: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Kind ("image/png" or "text/plain") and content of each output of a cell."""
    for output in cell.get("outputs", []):
        data = output.get("data", {"text/plain": output.get("text", "")})
        kind = "image/png" if "image/png" in data else "text/plain"
        yield kind, "".join(data[kind])


def notebook_pictures(name: str, notebook: Mapping[str, Any]) -> dict[str, bytes]:
    """PNG of each picture that a notebook shows, by file name."""
    images = [
        base64.b64decode(content)
        for cell in notebook["cells"]
        for kind, content in _outputs(cell)
        if kind == "image/png"
    ]
    return {f"{name}_{number}.png": picture for number, picture in enumerate(images)}


def notebook_page(name: str, notebook: Mapping[str, Any]) -> str:
    """A notebook as a page: its text, code and output, with a link to the file."""
    parts, pictures = [], iter(notebook_pictures(name, notebook))
    for cell in notebook["cells"]:
        text = "".join(cell["source"])
        parts.append(text if cell["cell_type"] == "markdown" else f"```python\n{text}\n```")
        for kind, content in _outputs(cell):
            if kind == "image/png":
                parts.append(f"![output](images/{next(pictures)})")
            else:
                parts.append(f"```text\n{content.rstrip()}\n```")
    title, *rest = parts
    heading, _, introduction = title.partition("\n")
    file = f"Download: [{name}.ipynb]({name}.ipynb)"
    return "\n\n".join([heading, introduction.strip(), file, *rest, ""])


# -- the site --------------------------------------------------------------------------------------


def breakable(text: str) -> str:
    """Names in the first columns of tables, which a browser may break after dots alone."""

    def name(match: re.Match[str]) -> str:
        return f"| <code>{match[1].replace('.', '.<wbr>')}</code> |"

    return re.sub(r"^\| `([^`]+)` \|", name, text, flags=re.MULTILINE)


def pages(drawn: Mapping[str, str]) -> dict[str, str]:
    """Text of all pages by their address in the site."""
    texts = api_pages()
    for path in [*_pages_of_docs(), *(file for file in _linked_files() if file.suffix == ".md")]:
        name = _in_site(path)
        texts[name] = _relinked(path.read_text(encoding="utf-8"), path, name)
    texts |= {
        f"{name}.md": notebook_page(name, notebook) for name, notebook in _notebooks().items()
    }
    readme = ROOT / "README.md"
    front = _relinked(readme.read_text(encoding="utf-8"), readme, "index.md")
    trees = [_toctree(title, names) for title, names in NAVIGATION.items()]
    trees.append(_toctree("Reference", ["api/index"]))
    listed = texts["index.md"].partition("\n")[2]
    texts["index.md"] = "\n".join([front, "## Documentation", listed, *trees])
    texts["figures.md"] += gallery(drawn)
    texts["settings.md"] = breakable(texts["settings.md"])
    return texts


def assemble(source: Path, drawn: Mapping[str, tuple[str, bytes]]) -> None:
    """Write the sources of the site into a directory, which is made anew."""
    shutil.rmtree(source, ignore_errors=True)
    listed = {name for names in NAVIGATION.values() for name in names}
    presets = {name: preset for name, (preset, _) in drawn.items()}
    for name, text in pages(presets).items():
        path = source / name
        path.parent.mkdir(parents=True, exist_ok=True)
        orphan = name.startswith("repository/") and name.removesuffix(".md") not in listed
        front = "---\norphan: true\n---\n\n" if orphan else ""
        path.write_text(front + text, encoding="utf-8")
    shutil.copytree(DOCS / "images", source / "images")
    shutil.copy(DOCS / "references.bib", source)
    for name, (_, picture) in drawn.items():
        (source / "images" / f"{name}.png").write_bytes(picture)
    for path in _linked_files():
        if path.suffix != ".md":
            target = source / _in_site(path)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, target)
    for name, notebook in _notebooks().items():
        shutil.copy(DOCS / f"{name}.ipynb", source)
        for file, picture in notebook_pictures(name, notebook).items():
            (source / "images" / file).write_bytes(picture)
    shutil.copy(DOCS / "site" / "conf.py", source)
    (source / "_static").mkdir()
    shutil.copy(DOCS / "site" / "extra.css", source / "_static")


def main() -> int:
    """Assemble the sources and build the site; 0 if nothing is wrong."""
    parser = argparse.ArgumentParser(description="Build the site of the documentation.")
    parser.add_argument("--output", type=Path, default=ROOT / "build" / "site")
    parser.add_argument("--check", action="store_true", help="write no page")
    options = parser.parse_args()
    source = options.output.with_name(f"{options.output.name}-sources")
    assemble(source, {} if options.check else pictures())
    builder = "dummy" if options.check else "html"
    return sphinx(
        ["-b", builder, "-W", "--keep-going", "-q", "-E", str(source), str(options.output)]
    )


if __name__ == "__main__":
    sys.exit(main())
