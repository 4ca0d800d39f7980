import json
import os

import pytest

from forbidden_code import offered_late, words_read
from snaketrust import code_hash
from snaketrust.code_hash import Code, Codes, parsed


@pytest.fixture
def module(tmp_path):
    path = tmp_path / "module.py"
    path.write_text("from . import other\nimport numpy.linalg\nVALUE = 1\n")
    return path


@pytest.fixture
def memory(tmp_path, module):
    """What is kept once the module has been looked at."""
    codes = Codes(tmp_path / "memory.json")
    codes.of(module)
    codes.keep()
    return tmp_path / "memory.json"


def edited(memory, change):
    found = json.loads(memory.read_text())
    change(found)
    memory.write_text(json.dumps(found))


def test_what_is_known_is_not_parsed_again(module, memory, monkeypatch):
    found = Codes().of(module)
    monkeypatch.setattr(code_hash, "parsed", None)  # cannot be called
    assert Codes(memory).of(module) == found
    assert found.imports == [("", 1), ("other", 1), ("numpy.linalg", 0)]


def test_an_edit_is_seen_whatever_was_kept(module, memory):
    codes = Codes(memory)
    found, times = codes.of(module), module.stat()
    module.write_text(module.read_text().replace("1\n", "2\n"))
    os.utime(module, ns=(times.st_atime_ns, times.st_mtime_ns))  # same size, same time
    assert codes.of(module) == found  # it has been read
    assert Codes(memory).of(module).digest != found.digest


def test_what_other_tools_kept_counts_nothing(module, memory):
    found = Codes().of(module)

    def other_digests(kept):
        for entry in kept["sources"].values():
            entry[0] = "made up"

    edited(memory, other_digests)
    assert Codes(memory).of(module) == Code("made up", found.imports, [])  # it is looked into
    edited(memory, lambda kept: kept.update(found_out_by="another version"))
    assert Codes(memory).of(module) == found


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"found_out_by": 1}', None])
def test_a_memory_of_no_use_is_none(tmp_path, module, text):
    if text is not None:
        (tmp_path / "kept.json").write_text(text)
    assert len(Codes(tmp_path / "kept.json").of(module).digest) == 12


def test_only_what_was_looked_at_is_kept(module, memory):
    module.write_text("VALUE = 3\n")
    codes = Codes(memory)
    codes.of(module)
    codes.keep()
    assert len(json.loads(memory.read_text())["sources"]) == 1
    assert sorted(os.listdir(memory.parent)) == ["memory.json", "module.py"]


def test_without_room_nothing_is_kept(tmp_path, module, monkeypatch):
    codes = Codes(tmp_path / "kept.json")
    codes.of(module)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    codes.keep()
    assert os.listdir(tmp_path) == ["module.py"]


# -- what is left out of the project's own code ----------------------------------------------------

LOGGER = "import logging\nlogger = logging.getLogger(__name__)\n"
LOGS = LOGGER + "def f(rows, counts):\n    {}\n    return rows, counts\n"
FAILS = "def f(rows, counts):\n    {}\n"
CAUGHT = "def f():\n    {}\ntry:\n    f()\nexcept ValueError as error:\n    %s\n"
SAYS = "logger.info('a')", "logger.info('b')"
NAMED = ("raise KeyError('a')", "raise KeyError('b')")
# Sources that do different things: a frame, and what stands in it. Their digests differ, or one of
# them is refused by `words_read` or `offered_late`.
APART = [
    *(  # an error of the project, with a value, or made by a call; what is called in its text
        (FAILS, one, other)
        for one, other in [
            ("raise Stop(1)", "raise Stop(2)"),
            ("raise Stop('a')", "raise Stop('b')"),
            ("raise SystemExit(1)", "raise SystemExit(2)"),
            ("raise StopIteration(rows)", "raise StopIteration(counts)"),
            ("raise made('type')", "raise made('value')"),
            ("raise ERRORS['a']('x')", "raise ERRORS['b']('x')"),
            ("raise OSError(2, 'a')", "raise OSError(5, 'a')"),
            ("raise KeyError('a') from rows.pop()", "raise KeyError('a')"),
            ("raise KeyError(f'{(x := 1)}')", "raise KeyError('a')"),
            ("raise KeyError(f'{rows.pop()}')", "raise KeyError('a')"),
            ("raise KeyError(f'{list(rows)}')", "raise KeyError('')"),
        ]
    ),
    *(  # an error's text that is read where it was caught
        (CAUGHT % handled, "raise ValueError('1')", "raise ValueError('2')")
        for handled in [
            *("return str(error)", "return error.args", "return sys.exc_info()[1]"),
            *("raise (A if '1' in str(error) else B)('x')", "raise Stop(error.args[0])"),
            "return h().__cause__",
        ]
    ),
    ("class ValueError(E): ...\n{}", "raise ValueError('a')", "raise ValueError('b')"),
    ("def __exit__(self, kind, error, place):\n    self.text = str(error)\n" + FAILS, *NAMED),
    ("from traceback import format_exc\n" + FAILS, *NAMED),
    *(  # more than names in the log
        (LOGS, f"logger.info({said})", "logger.info('')")
        for said in [
            *("'%s', rows.pop()", "'%s', next(rows)", "'%s', list(rows)", "', '.join(rows)"),
            *("'%s', [row for row in rows]", "'%s', *rows", "f'{counts[0]}'", "'%s', (yield 1)"),
            *("'', extra=rows.pop()", "'%s', type('A', counts, rows)"),
        ]
    ),
    (LOGS, "logger.info('%s', rows := 1)", "logger.info('%s', rows := 2)"),
    (LOGS, "len = rows.remove; logger.info('%s', len(1))", "len = rows.remove"),
    (LOGS, "logger.addHandler(rows)", "pass"),
    *(  # another logger, or one that does more than log
        (frame, *SAYS)
        for frame in [
            LOGS + "logging.getLogger().addHandler(H())\n",
            LOGS + "class H(logging.Handler): ...\n",
            "from logging import Filter\n" + LOGS,
            "logger = Recorder()\n{}",
            LOGGER + "logger = Recorder()\n{}",
            LOGGER + "globals()['logger'] = R()\n{}",
            LOGS + "other.logger = Recorder()\n",
            "def f(logger):\n    {}",
            "import recorder as logging\n" + LOGS,
        ]
    ),
    # what says no more than a docstring; docstrings that are read
    ("class A:\n    {}\n    x = 1", *(f"def __repr__(self): return {text}" for text in (1, 2))),
    ("class A:\n    {}\n    def __repr__(self): return ''", "@register", "@other"),
    *(
        ('"""{}"""\n' + reads, "a", "b")
        for reads in [
            *("TEXT = __doc__\n", "TEXT = A.__doc__\n", "TEXT = inspect.getdoc(A)\n"),
            "from ast import get_docstring\n",
        ]
    ),
    # what a module or a package offers late
    ("def __getattr__(name):\n    {}\n", "return 1", "return 2"),
    ("def __dir__():\n    {}\n", "return ['a']", "return ['b']"),
    *(
        (f"{use}\n{{}}", "'a'", "'b'")
        for use in [
            *("from package import VALUE", "import package\nx = package.VALUE"),
            *("import package\nx = getattr(package, 'x')", "import package as p\nx = p.VALUE"),
        ]
    ),
]


def digest_of(source, strict=False):
    source = source if isinstance(source, bytes) else source.encode()
    return parsed(source, "module.py", strict=strict).digest


@pytest.fixture
def package(tmp_path):
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "module.py").write_text("")
    return tmp_path / "package"


@pytest.mark.parametrize(("frame", "one", "other"), APART)
def test_what_is_left_out_cannot_matter(tmp_path, package, frame, one, other):
    sources, refused, path = [frame.replace("{}", text, 1) for text in (one, other)], [], tmp_path
    for source in sources:
        path = tmp_path / "module.py"
        path.write_text(source)
        refused += [*words_read(path), *offered_late(path, package)]
    assert digest_of(sources[0]) != digest_of(sources[1]) or refused


@pytest.mark.parametrize(
    "handled",
    [
        *("raise KeyError(f'{error}') from error", "raise", "raise error", "return 1"),
        "logger.warning('%s: %s', type(error).__name__, error)",
        "return type(error).__name__",
    ],
)
def test_an_error_may_be_told_on(tmp_path, handled):
    path = tmp_path / "module.py"
    path.write_text(CAUGHT % handled)
    assert words_read(path) == []
    path.write_text("def g(h):\n    " + (CAUGHT % "return str(error)").replace("\n", "\n    "))
    assert len(words_read(path)) == 1
    assert words_read(path, frozenset({"g"})) == []


def test_modules_of_a_package_may_be_imported(tmp_path, package):
    path = tmp_path / "source.py"
    path.write_text("import package.module\nfrom package import module\npackage.module.f()\n")
    assert offered_late(path, package) == []


CODE = '''
"""What it does."""
import math

LIMIT = 10  # a comment

class Thing:
    """A thing."""
    size: float = 1.0
    """Its size."""

    def area(self, factor: float = 2, *, deep=None) -> float:
        """Area."""
        if self.size > LIMIT:
            pass
        return f"{factor * self.size ** 2:.3f} {deep!r}"
'''
SPEAKING = """
import logging
logger = logging.getLogger(__name__)

def check(value):
    logger.info("value %s", value)
    if value < 0:
        raise ValueError(f"{value} is negative")
    try:
        return 1 / value
    except ZeroDivisionError as error:
        logger.warning("no inverse")
        raise KeyError("zero") from error
"""
SHOWN = "class Network:\n    def size(self):\n        return 3\n\ndef network():\n    return 4\n"
SAID = 'logger.info("value %s", value)'
# Edits without meaning: they change no digest.
NO_MEANING = [
    (CODE, "# a comment", "# another"),
    (CODE, '"""What it does."""', '"""Something else."""'),
    (CODE, '"""What it does."""', ""),
    (CODE, '    """A thing."""', "    '''Two\n    lines.'''"),
    (CODE, '    """Its size."""', ""),
    (CODE, '        """Area."""', ""),
    (CODE, "LIMIT = 10", "\n\n\nLIMIT   =   (10)"),
    (CODE, "LIMIT = 10", "LIMIT = 1_0"),
    (CODE, "factor: float = 2, *, deep=None", "\n        factor: float = 2, *,\n deep=None,"),
    (CODE, 'f"{factor * self.size ** 2:.3f} ', "f'{factor * self.size ** 2:.3f} '\\\n  f\""),
    (SPEAKING, 'f"{value} is negative"', '"value must not be negative"'),
    (SPEAKING, 'f"{value} is negative"', 'f"{value:.3g} of {len(name)} is", "negative"'),
    (SPEAKING, 'KeyError("zero")', 'KeyError("there is no inverse")'),
    (SPEAKING, SAID, 'logger.info("checking")'),
    (SPEAKING, SAID, 'logger.info("a %s", type(value).__name__)'),
    (SPEAKING, f"    {SAID}\n", ""),
    (SPEAKING, 'logger.warning("no inverse")', 'logger.error("no inverse of %s", value)'),
    # what only people ask for
    (SHOWN, "return 4\n", "return 4\n\ndef __getattr__(name):\n    raise AttributeError(name)\n"),
    (SHOWN, "return 4\n", "return 4\n\ndef __dir__():\n    return ['network']\n"),
]
# Edits with meaning: each changes the digest.
MEANING = [
    *(
        (CODE, old, new)
        for old, new in [
            *(("LIMIT = 10", f"LIMIT{new}") for new in (" = 11", " = 10.0", " = '10'", " = True")),
            ("LIMIT = 10", "LIMIT: int = 10"),
            *(("import math", new) for new in ("import math as m", "from math import pi", "")),
            *(("** 2", new) for new in ("** -2", "* 2")),
            *(("deep=None", new) for new in ("deep", "deep=0")),
            *(("class Thing:", new) for new in ("class Thing(dict):", "@final\nclass Thing:")),
            *((("> LIMIT", ">= LIMIT"), (":.3f", ":.4f"), ("!r}", "!s}"), ("*, deep", "deep"))),
            *((("factor: float", "factor: int"), ("size: float = 1.0", "size = 1.0"))),
            *((("    pass", "    return 0"), ("self.size ** 2", "self.area ** 2"))),
        ]
    ),
    *(
        (SPEAKING, old, new)
        for old, new in [
            *((SAID, new) for new in ('print("value %s", value)', f"value = {SAID}")),
            *(
                (SAID, new)
                for new in (SAID.replace("logger", "other"), SAID[:-6] + "float(value))")
            ),
            *(('raise KeyError("zero") from error', new) for new in ("raise", "return KeyError()")),
            ('raise ValueError(f"', 'raise TypeError(f"'),
            ('raise ValueError(f"{value} is negative")', "pass"),
            ("except ZeroDivisionError", "except ValueError"),
            *((("if value < 0", "if value < 1"), ('KeyError("zero")', "KeyError(value)"))),
            ("logging.getLogger(__name__)", "recorder()"),
        ]
    ),
    # what code asks for
    (SHOWN, "return 3\n", "return 3\n\n    def __getattr__(self, name):\n        return 4\n"),
    (SHOWN, "return 3\n", "return 3\n\n    def __repr__(self):\n        return 'network'\n"),
    (SHOWN, "return 3\n", "return 3\n\n    def __str__(self):\n        return 'network'\n"),
    (SHOWN, "return 4\n", "return 4\n\ndef __repr__():\n    return 'module'\n"),
]


@pytest.mark.parametrize(
    ("source", "old", "new", "equal"),
    [*((*row, True) for row in NO_MEANING), *((*row, False) for row in MEANING)],
)
def test_what_means_the_same_has_the_same_digest_and_nothing_else(source, old, new, equal):
    assert old in source
    assert (digest_of(source.replace(old, new)) == digest_of(source)) == equal


def test_a_digest_is_the_same_in_every_version_of_python():
    # computed with Python 3.11; a version with another syntax tree must not rerun whole campaigns.
    # Python 3.12 has empty text in a nested format specification and fields for type parameters.
    code = CODE + (
        "\ndef show(value, width, formats):\n"
        '    return f"{value:{formats[width]}}" rf"{value!r:>{width}}\\pi" "plain" f"{value=}"\n'
    )
    assert digest_of(code) == "c0ace66b1615"


# Sources that do different things, whoever wrote them: their digests differ.
DIFFERENT = [
    ("x = 1", "x = 1.0"),
    ("x = ['']", "x = ['', '']"),
    ("x = 1", "x = True"),
    ("x = 0.0", "x = -0.0"),
    ("x = 1", "x = 1j"),
    ("x = 1e999", "x = 1e308"),
    ("x = 'a'", "x = b'a'"),
    ("x = '\ufb01'", "x = 'fi'"),
    ("x = None", "x = ..."),
    ("x = 'None'", "x = None"),
    ("x = '\\x1f'", "x = ''"),
    ("x = f'{y}'", "x = f'{y!s}'"),
    ("x = f'{y}'", "x = f'{y:}'"),
    ("""x = f'{y["a"]}'""", """x = f'{y["b"]}'"""),
    ("x = f'{y=}'", "x = f'{y =}'"),
    ("@a\n@b\ndef f(): ...", "@b\n@a\ndef f(): ..."),
    ("def f(a=1, *, b): ...", "def f(a, *, b=1): ..."),
    ("def f(a, /, b): ...", "def f(a, b, /): ..."),
    ("def f(a, b): ...", "def f(b, a): ..."),
    ("f(a=1, b=2)", "f(b=2, a=1)"),
    ("f(*a, **b)", "f(**b)"),
    ("class A(B, x=1): ...", "class A(B, x=2): ..."),
    ("class A(B): ...", "class A(metaclass=B): ..."),
    ("def f():\n    global x\n    x = 1", "def f():\n    x = 1"),
    ("def f():\n    global x\n    x = 1", "def f():\n    nonlocal x\n    x = 1"),
    ("del x", "x"),
    ("from __future__ import annotations", ""),
    ("try:\n    import a\nexcept E:\n    import b", "try:\n    import b\nexcept E:\n    import a"),
    ("from a import *", "import a"),
    ("from . import a", "from .. import a"),
    ("from .a import b", "from a import b"),
    ("import a.b", "import a.b as a"),
    ("x: int", "x: int = None"),
    ("x: int = 1", "(x): int = 1"),
    ("a < b < c", "a < b and b < c"),
    ("x[1:2]", "x[1:2:]\nx[:1]"),
    ("x[:1]", "x[1:]"),
    ("[a for b in c if d if e]", "[a for b in c if d and e]"),
    ("async def f():\n    [a async for a in b]", "async def f():\n    [a for a in b]"),
    ("def f():\n    yield a", "def f():\n    yield from a"),
    ("try:\n    a()\nexcept:\n    b()", "try:\n    a()\nexcept None:\n    b()"),
    ("try:\n    a()\nexcept E:\n    b()", "try:\n    a()\nexcept* E:\n    b()"),
    ("try:\n    a()\nexcept E: b()\nelse: c()", "try:\n    a()\n    c()\nexcept E: b()"),
    ("for a in b:\n    c()\nelse:\n    d()", "for a in b:\n    c()\nd()"),
    ("match a:\n    case None: b()", "match a:\n    case True: b()"),
    ("match a:\n    case _: b()", "match a:\n    case x: b()"),
    ("match a:\n    case [*_]: b()", "match a:\n    case [*x]: b()"),
    ("match a:\n    case {'k': 1}: b()", "match a:\n    case {'k': 1, **x}: b()"),
    ("with a as b: c()", "with a: c()"),
    ("assert a, 'b'", "assert a, 'c'"),
    ("x = (1, 2)", "x = [1, 2]"),
    ("{**a, 'b': c}", "{'b': c, **a}"),
    (b"# coding: latin-1\nx = '\xe9'", b"# coding: cp1251\nx = '\xe9'"),
    ("x = 'a'  'b'", "x = 'a', 'b'"),
    ("f(a)(b)", "f(a, b)"),
    ("a - (b - c)", "a - b - c"),
    ("[[a], b]", "[[a, b]]"),
    ("if a:\n    b()\nc()", "if a:\n    b()\n    c()"),
    ("if a:\n    b()\nelse:\n    c()", "if a:\n    b()\n    c()"),
    ("f(a=b)", "f(b)"),
    ("{**a}", "{None: a}"),
    ("x = 'a\\x1fb'", "x = 'a', 'b'"),
    ("lambda a, b=1: 0", "lambda a=1, b=1: 0"),
    ("def f(*, a, b=1): f()", "def f(*, a=1, b): f()"),
]
# Sources that do the same.
SAME = [
    ("x = 16", "x = 0x1_0"),
    ("x = 'a' 'b'", 'x = "ab"'),
    ("x = u'a'", "x = r'a'"),
    ("\ufb01 = 1", "fi = 1"),
    ("x = 1 + \\\n    2", "x = (1 + 2)"),
    ("x = 1  # type: int", "x = 1"),
    (b"# coding: latin-1\nx = '\xe9'", "x = '\xe9'"),
    ("x = 1; y = 2", "x = 1\r\ny = 2\n"),
]


@pytest.mark.parametrize("strict", [False, True])
@pytest.mark.parametrize(
    ("one", "other", "equal"),
    [*((*pair, False) for pair in DIFFERENT), *((*pair, True) for pair in SAME)],
)
def test_whoever_wrote_them_sources_that_do_the_same_have_one_digest(one, other, equal, strict):
    assert (digest_of(one, strict) == digest_of(other, strict)) == equal


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ('"""a"""', '"""b"""'),
        ('def f():\n    """a"""', 'def f():\n    """b"""'),
        ("raise ValueError('a')", "raise ValueError('b')"),
        tuple(LOGS.replace("{}", text) for text in SAYS),
        (LOGS.replace("{}", SAYS[0]), LOGS.replace("{}", "pass")),
        ("def __getattr__(name):\n    return 1", "def __getattr__(name):\n    return 2"),
    ],
)
def test_words_of_a_users_module_count(one, other):
    assert digest_of(one, strict=True) != digest_of(other, strict=True)
    assert digest_of(one) == digest_of(other)


def test_a_sum_of_many_terms_is_no_trouble():
    terms = " + ".join(f"x{number}" for number in range(2500))
    assert len({digest_of(f"y = {terms} + {end}", strict=True) for end in ("a", "b")}) == 2


def test_of_a_compiled_module_the_bytes_count(tmp_path):
    digests, path = set(), tmp_path / "module.so"
    for content in (b"\x7fELF a", b"\x7fELF b"):
        path.write_bytes(content)
        digests.add(Codes().of(path, strict=True).digest)
    assert len(digests) == 2


# -- what fingerprints do not see ------------------------------------------------------------------


@pytest.mark.parametrize(
    "code",
    [
        *("exec(text)", "eval(text)", "run = exec", "import runpy; runpy.run_path(name)"),
        *("from pkgutil import iter_modules", "__import__(name)", "importlib.import_module(name)"),
        *("here = Path(__file__).parent", "sys.path.insert(0, place)"),
        *("importlib.resources.files(package)", "from importlib.resources import files"),
        *("snakemake.config['low']", "value = snakemake.config", "getattr(snakemake, name)"),
        *("os.environ['LOW']", "os.getenv('LOW')", "environ.get('LOW')"),
        *("open('low.txt')", "Path('low.txt').read_text()", "Path('low.txt').open()"),
        *("np.load('low.npy')", "pd.read_csv('low.csv')", "xr.open_dataset('low.nc')"),
        *("subprocess.run([sys.executable, name])", "os.system('python low.py')"),
    ],
)
def test_what_is_not_seen_is_told_by_its_line(code):
    (*_, place) = parsed(f"\n{code}\n".encode(), "a.py", strict=True).unseen
    assert place.startswith("line 2: ")


@pytest.mark.parametrize(
    "code",
    [
        *("import_module('json')", "re.compile(text)", "frame.eval(text)", "model.eval()"),
        *("open(snakemake.input[0])", "Path(snakemake.input['low']).read_text()"),
        *("open('low.txt', 'w')", "Path('low.txt').open('w')", "open('low.txt', mode='wb')"),
        *("os.environ['LOW'] = '1'", "os.environ.setdefault('LOW', '1')", "pd.read_csv(path)"),
        *("subprocess.run(['bcftools', path])", "snakemake.params.low", "print(__doc__)"),
        *("zipfile.ZipFile(snakemake.input[0]).open('member')", "run(python)"),
    ],
)
def test_what_is_seen_or_cannot_be_noticed_is_not_refused(code):
    assert not parsed(code.encode(), "a.py", strict=True).unseen
