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
CAUGHT = """
def f():
    raise {error}
def g():
    try:
        f()
    except ValueError as error:
        {handled}
"""
DOCUMENTED = '"""{}"""\n'
# Sources that do different things: a frame, and what stands in it. Their digests differ, or one of
# them is refused by `words_read` or `offered_late`.
APART = {
    "a value in an error of the project": (FAILS, "raise Stop(1)", "raise Stop(2)"),
    "a text in an error of the project": (FAILS, "raise Stop('a')", "raise Stop('b')"),
    "an exit status": (FAILS, "raise SystemExit(1)", "raise SystemExit(2)"),
    "a generator's value": (FAILS, "raise StopIteration(rows)", "raise StopIteration(counts)"),
    "an error that a function makes": (FAILS, "raise made('type')", "raise made('value')"),
    "an error in a list": (FAILS, "raise ERRORS['a']('x')", "raise ERRORS['b']('x')"),
    "an error's name taken": (
        "class ValueError(E): ...\n{}",
        "raise ValueError('a')",
        "raise ValueError('b')",
    ),
    "a number in an error": (FAILS, "raise OSError(2, 'a')", "raise OSError(5, 'a')"),
    "a cause": (FAILS, "raise KeyError('a') from rows.pop()", "raise KeyError('a')"),
    "a name bound in an error": (FAILS, "raise KeyError(f'{(x := 1)}')", "raise KeyError('a')"),
    "a call in an error": (FAILS, "raise KeyError(f'{rows.pop()}')", "raise KeyError('a')"),
    "a generator drawn from in an error": (
        FAILS,
        "raise KeyError(f'{list(rows)}')",
        "raise KeyError('')",
    ),
    "the text of an error that is read": (
        CAUGHT,
        "raise ValueError('1')",
        "raise ValueError('2')",
        "return str(error)",
    ),
    "arguments of an error": (
        CAUGHT,
        "raise ValueError('1')",
        "raise ValueError('2')",
        "return error.args",
    ),
    "an error's text decides on another": (
        CAUGHT,
        "raise ValueError('1')",
        "raise ValueError('2')",
        "raise (A if '1' in str(error) else B)('x')",
    ),
    "an error's text in a value of another": (
        CAUGHT,
        "raise ValueError('1')",
        "raise ValueError('2')",
        "raise Stop(error.args[0])",
    ),
    "an error that is found otherwise": (
        CAUGHT,
        "raise ValueError('1')",
        "raise ValueError('2')",
        "return sys.exc_info()[1]",
    ),
    "a cause that is read": (
        CAUGHT,
        "raise ValueError('1')",
        "raise ValueError('2')",
        "return h().__cause__",
    ),
    "an error in a context manager": (
        "def __exit__(self, kind, error, place):\n    self.text = str(error)\ndef f():\n    {}",
        "raise KeyError('a')",
        "raise KeyError('b')",
    ),
    "a traceback": (
        "from traceback import format_exc\n" + FAILS,
        "raise KeyError('a')",
        "raise KeyError('b')",
    ),
    "a name bound in the log": (
        LOGS,
        "logger.info('%s', rows := 1)",
        "logger.info('%s', rows := 2)",
    ),
    "a call in the log": (LOGS, "logger.info('%s', rows.pop())", "logger.info('')"),
    "what is drawn in the log": (LOGS, "logger.info('%s', next(rows))", "logger.info('')"),
    "a list of a generator in the log": (LOGS, "logger.info('%s', list(rows))", "logger.info('')"),
    "a generator joined in the log": (LOGS, "logger.info(', '.join(rows))", "logger.info('')"),
    "a comprehension in the log": (
        LOGS,
        "logger.info('%s', [row for row in rows])",
        "logger.info('')",
    ),
    "an unpacked generator in the log": (LOGS, "logger.info('%s', *rows)", "logger.info('')"),
    "an entry that the log makes": (LOGS, "logger.info(f'{counts[0]}')", "logger.info('')"),
    "a generator that the log stops in": (LOGS, "logger.info('%s', (yield 1))", "logger.info('')"),
    "a keyword in the log": (LOGS, "logger.info('', extra=rows.pop())", "logger.info('')"),
    "a length that is not": (
        LOGS,
        "len = rows.remove; logger.info('%s', len(1))",
        "len = rows.remove",
    ),
    "a class made in the log": (
        LOGS,
        "logger.info('%s', type('A', counts, rows))",
        "logger.info('')",
    ),
    "a handler": (LOGS, "logger.addHandler(rows)", "pass"),
    "what a handler gets": (
        LOGS + "logging.getLogger().addHandler(H())\n",
        "logger.info('a')",
        "logger.info('b')",
    ),
    "a handler's class": (
        LOGS + "class H(logging.Handler): ...\n",
        "logger.info('a')",
        "logger.info('b')",
    ),
    "a filter from the module": (
        "from logging import Filter\n" + LOGS,
        "logger.info('a')",
        "logger.info('b')",
    ),
    "another logger": ("logger = Recorder()\n{}", "logger.info('a')", "logger.info('b')"),
    "a logger that is replaced": (
        LOGGER + "logger = Recorder()\n{}",
        "logger.info('a')",
        "logger.info('b')",
    ),
    "a logger by its name": (
        LOGGER + "globals()['logger'] = R()\n{}",
        "logger.info('a')",
        "logger.info('b')",
    ),
    "another module's logger": (
        LOGS + "other.logger = Recorder()\n",
        "logger.info('a')",
        "logger.info('b')",
    ),
    "an argument that is a logger": (
        "def f(logger):\n    {}",
        "logger.info('a')",
        "logger.info('b')",
    ),
    "another module called logging": (
        "import recorder as logging\n" + LOGS,
        "logger.info('a')",
        "logger.info('b')",
    ),
    "what says no more than a docstring": (
        "class A:\n    {}\n    x = 1",
        "def __repr__(self): return 'a'",
        "def __repr__(self): return 'b'",
    ),
    "a decorated __repr__": (
        "class A:\n    {}\n    def __repr__(self): return ''",
        "@register",
        "@other",
    ),
    "a docstring that is read": (DOCUMENTED + "TEXT = __doc__\n", "a", "b"),
    "a docstring of a class": (DOCUMENTED + "TEXT = A.__doc__\n", "a", "b"),
    "a docstring that a library reads": (DOCUMENTED + "TEXT = inspect.getdoc(A)\n", "a", "b"),
    "a docstring in a source": (DOCUMENTED + "from ast import get_docstring\n", "a", "b"),
    "what a module offers late": ("def __getattr__(name):\n    {}\n", "return 1", "return 2"),
    "what a module lists": ("def __dir__():\n    {}\n", "return ['a']", "return ['b']"),
    "what a package offers late": ("from package import VALUE\n{}", "'a'", "'b'"),
    "what a package offers by its name": ("import package\nx = package.VALUE\n{}", "'a'", "'b'"),
    "a package that is handed on": ("import package\nx = getattr(package, 'x')\n{}", "'a'", "'b'"),
    "a package by another name": ("import package as p\nx = p.VALUE\n{}", "'a'", "'b'"),
}


def digest_of(source, path, *, strict=False):
    path.write_bytes(source if isinstance(source, bytes) else source.encode())
    return Codes().of(path, strict=strict).digest


@pytest.mark.parametrize("what", APART)
def test_what_is_left_out_cannot_matter(tmp_path, what):
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "module.py").write_text("")
    frame, one, other, *handled = APART[what]
    digests, refused, path = [], [], tmp_path / "module.py"
    for text in (one, other):
        if handled:
            source = frame.format(error=text.removeprefix("raise "), handled=handled[0])
        else:
            source = frame.format(text)
        digests.append(digest_of(source, path))
        refused += [*words_read(path), *offered_late(path, tmp_path / "package")]
    assert digests[0] != digests[1] or refused


@pytest.mark.parametrize(
    "handled",
    [
        "raise KeyError(f'{error}') from error",
        "raise",
        "raise error",
        "logger.warning('%s: %s', type(error).__name__, error)",
        "return type(error).__name__",
        "return 1",
    ],
)
def test_an_error_may_be_told_on(tmp_path, handled):
    path = tmp_path / "module.py"
    path.write_text(CAUGHT.format(error="ValueError('1')", handled=handled))
    assert words_read(path) == []
    path.write_text(CAUGHT.format(error="ValueError('1')", handled="return str(error)"))
    assert len(words_read(path)) == 1
    assert words_read(path, frozenset({"g"})) == []


def test_modules_of_a_package_may_be_imported(tmp_path):
    path = tmp_path / "source.py"
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "module.py").write_text("")
    path.write_text("import package.module\nfrom package import module\npackage.module.f()\n")
    assert offered_late(path, tmp_path / "package") == []


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
@pytest.mark.parametrize(("one", "other"), DIFFERENT)
def test_sources_that_do_different_things_have_different_digests(tmp_path, one, other, strict):
    path = tmp_path / "module.py"
    assert digest_of(one, path, strict=strict) != digest_of(other, path, strict=strict)


@pytest.mark.parametrize("strict", [False, True])
@pytest.mark.parametrize(("one", "other"), SAME)
def test_sources_that_do_the_same_have_the_same_digest(tmp_path, one, other, strict):
    path = tmp_path / "module.py"
    assert digest_of(one, path, strict=strict) == digest_of(other, path, strict=strict)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ('"""a"""', '"""b"""'),
        ('def f():\n    """a"""', 'def f():\n    """b"""'),
        ("raise ValueError('a')", "raise ValueError('b')"),
        (LOGS.format("logger.info('a')"), LOGS.format("logger.info('b')")),
        (LOGS.format("logger.info('a')"), LOGS.format("pass")),
        ("def __getattr__(name):\n    return 1", "def __getattr__(name):\n    return 2"),
    ],
)
def test_words_of_a_users_module_count(tmp_path, one, other):
    path = tmp_path / "module.py"
    assert digest_of(one, path, strict=True) != digest_of(other, path, strict=True)
    assert digest_of(one, path) == digest_of(other, path)


def test_a_sum_of_many_terms_is_no_trouble(tmp_path):
    terms = " + ".join(f"x{number}" for number in range(2500))
    path = tmp_path / "module.py"
    digests = {digest_of(f"y = {terms} + {end}", path, strict=True) for end in ("a", "b")}
    assert len(digests) == 2


def test_of_a_compiled_module_the_bytes_count(tmp_path):
    path = tmp_path / "module.so"
    assert digest_of(b"\x7fELF a", path, strict=True) != digest_of(b"\x7fELF b", path, strict=True)


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
