"""Turns of phrase that are hard to read do not come back: "who forecasts", "nobody", "is told".

Forecasters and jobs are things: a noun names them. Code is not looked at, except for its comments,
docstrings and messages.
"""

import ast
import re
import tokenize
from pathlib import Path

import pytest
import snakemake

ROOT = Path(__file__).parents[1]
PEOPLE = ("people", "maintainer", "user", "author", "authors", "authors'", "reader", "person")
NOT_PEOPLE = "".join(f"(?<!{word} )(?<!{word}, )" for word in PEOPLE)
BANNED = {
    "who": rf"{NOT_PEOPLE}\bwho\b",
    "nobody, everybody": r"\b(?:nobody|somebody|everybody|everyone)\b",
    "is told": r"\b(?:is|are|was|were|be|been) told\b",
    "told apart": r"\btold apart\b",
    "those that": r"\bthose (?:that|who)\b",
    "what is asked": r"\bwhat is asked of\b",
    "from which on": r"\bfrom which on\b",
    "as above": r"\bas above\b",
    "the same.": r"\b(?:is|are|was|were) the same\.",
}
# generated from sources that are checked themselves, or from results
GENERATED = ("results.md", "settings.md", "tables.md")
# parts of f-strings are tokens of their own from Python 3.12 on
WORDS = (tokenize.COMMENT, tokenize.STRING, getattr(tokenize, "FSTRING_MIDDLE", -1))


def prose_files():
    files = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), ROOT / "config.yaml"]
    for folder in ("workflow", "profiles", "examples", "config"):
        files += [
            path
            for path in (ROOT / folder).rglob("*")
            if path.suffix in (".smk", ".yaml", ".md", ".rst", ".py")
        ]
    files += [ROOT / "Snakefile", ROOT / "Makefile", *(ROOT / "src").rglob("*.py")]
    return [path for path in files if path.name not in GENERATED and "egg-info" not in path.parts]


def words_of_code(path):
    """Comments and strings of a Python file, with their lines."""
    with tokenize.open(path) as file:
        for token in tokenize.generate_tokens(file.readline):
            if token.type in WORDS:
                yield token.start[0], token.string


def offences(text):
    """Names of the banned turns in a text, whatever lines they are broken into."""
    # names of variables in f-strings, and of parameters in docstrings, are code
    text = re.sub(r"\{[^{}]*\}|^ +\w+(?:, \w+)*$", "", text, flags=re.MULTILINE)
    one_line = " ".join(text.split())
    return [name for name, turn in BANNED.items() if re.search(turn, one_line, re.IGNORECASE)]


def test_banned_turns_are_found():
    assert offences("a table of\nwho forecasts") == ["who"]
    assert offences("a user who pays, the authors, who divide") == []
    assert offences("The monitor is told\nof it; Nobody asks; those that vote") == [
        "nobody, everybody",
        "is told",
        "those that",
    ]
    assert offences("these are the same. As above:") == ["as above", "the same."]
    assert offences("the same bits, those of the search") == []
    assert offences("Parameters\n    ----------\n    who\n        The forecaster {who}.") == []


@pytest.mark.parametrize("folder", ["src", "workflow", ""])
def test_sentences_keep_to_nouns(folder):
    offending = {}
    for path in prose_files():
        name = path.relative_to(ROOT)
        if folder != (name.parts[0] if name.parts[0] in ("src", "workflow") else ""):
            continue
        if path.suffix == ".py":
            texts = list(words_of_code(path))
        else:
            texts = [(1, path.read_text(encoding="utf-8"))]
        for line, text in texts:
            if turns := offences(text):
                offending[f"{name}:{line}"] = turns
    assert offending == {}


def messages_of_sources():
    """Texts of the product and of Snakemake, with … where values stand."""
    messages = []
    for root in (ROOT / "src", ROOT / "workflow" / "scripts", Path(snakemake.__file__).parent):
        for path in root.rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text())):
                parts = node.values if isinstance(node, ast.JoinedStr) else [node]
                texts = [part.value if isinstance(part, ast.Constant) else "…" for part in parts]
                if isinstance(node, ast.JoinedStr | ast.Constant):
                    messages.append(
                        "".join(text if isinstance(text, str) else "" for text in texts)
                    )
    return "\n".join(messages)


def test_each_message_of_the_page_of_errors_is_one_of_the_sources():
    sources = messages_of_sources()
    page = (ROOT / "docs" / "errors.md").read_text()
    cells = [line.split("|")[1] for line in page.splitlines() if line.startswith("| `")]
    messages = [message for cell in cells for message in re.findall(r"`(.+?)`", cell)]
    assert len(messages) > 20
    for message in messages:
        parts = [re.escape(part) for part in message.split("…")]
        assert re.search("[^\n]*…[^\n]*".join(parts), sources), message
