"""The page of references, ``docs/references.md``, from ``docs/references.bib``.

``make pages`` writes it. Each work has a heading, its key in the bibliography, so that a page cites
it by a plain link, ``[Racca & Magri (2022)](references.md#racca2022)``, which the site and
repository hosts follow alike.
"""

import re
import textwrap
from pathlib import Path

BIBLIOGRAPHY = Path(__file__).parents[1] / "references.bib"
INTRODUCTION = """\
# References

Which works do these pages cite? Made from [references.bib](references.bib) by `make pages`.
"""
_ENTRY = re.compile(r"^@\w+\{(?P<key>\w+),\n(?P<fields>.*?)^\}", re.MULTILINE | re.DOTALL)
_FIELD = re.compile(r"^ *(\w+) = \{(.*?)\},?$", re.MULTILINE | re.DOTALL)
# Addresses and texts of links, by the field that has the identifier of a work
LINKS = {"doi": "https://doi.org/", "eprint": "https://arxiv.org/abs/", "url": ""}
LABELS = {"doi": "doi:{}", "eprint": "arXiv:{}", "url": "abstract"}


def entries(bibliography: str) -> dict[str, dict[str, str]]:
    """Fields of each work in the text of a BibTeX file, by key."""
    return {
        entry["key"]: {name: " ".join(text.split()) for name, text in _FIELD.findall(entry[0])}
        for entry in _ENTRY.finditer(bibliography)
    }


def reference(fields: dict[str, str]) -> str:
    """One work as a paragraph of Markdown: authors, title, place, year, links."""
    names = [author.split(", ") for author in fields["author"].split(" and ")]
    authors = ", ".join(" ".join(reversed(name)) for name in names)
    place = fields.get("journal", fields.get("booktitle", fields.get("publisher", "")))
    numbers = [fields[name] for name in ("volume", "pages") if name in fields]
    source = " ".join(filter(None, [f"*{place}*" if place else "", ", ".join(numbers)]))
    links = [
        f"[{LABELS[name].format(fields[name])}]({address}{fields[name]})"
        for name, address in LINKS.items()
        if name in fields
    ]
    parts = [f"{authors} ({fields['year']}): {fields['title']}", source, *links]
    return " ".join(part if part.endswith("?") else f"{part}." for part in parts if part)


def page(bibliography: str) -> str:
    """Text of the page of references."""
    parts = [INTRODUCTION]
    for key, fields in sorted(entries(bibliography).items()):
        lines = textwrap.fill(
            reference(fields), 100, break_long_words=False, break_on_hyphens=False
        )
        parts.append(f"## {key}\n\n{lines}\n")
    return "\n".join(parts)


if __name__ == "__main__":
    print(page(BIBLIOGRAPHY.read_text(encoding="utf-8")), end="")
