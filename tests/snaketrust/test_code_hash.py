import ast
import json
import os
import re
from contextlib import suppress
from itertools import combinations
from pathlib import Path

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
    """What `Codes` keep once the module has been looked at."""
    codes = Codes(tmp_path / "memory.json")
    codes.of(module)
    codes.keep()
    return tmp_path / "memory.json"


def test_codes_keep_what_is_known_of_the_sources_that_were_looked_at(module, memory, monkeypatch):
    found, times = Codes().of(module), module.stat()
    assert found.imports == [("", 1), ("other", 1), ("numpy.linalg", 0)]
    with monkeypatch.context() as context:
        context.setattr(code_hash, "parsed", None)  # cannot be called
        codes = Codes(memory)
        assert codes.of(module) == found
    module.write_text(module.read_text().replace("1\n", "2\n"))
    os.utime(module, ns=(times.st_atime_ns, times.st_mtime_ns))  # same size, same time
    assert codes.of(module) == found  # it has been read
    codes = Codes(memory)
    assert codes.of(module).digest != found.digest
    codes.keep()
    assert len(json.loads(memory.read_text())["sources"]) == 1
    assert sorted(os.listdir(memory.parent)) == ["memory.json", "module.py"]


def test_codes_of_another_version_and_a_memory_of_no_use_count_nothing(module, memory):
    found, kept = Codes().of(module), json.loads(memory.read_text())
    for entry in kept["sources"].values():
        entry[0] = "made up"
    memory.write_text(json.dumps(kept))
    assert Codes(memory).of(module) == Code("made up", found.imports, [])  # it is looked into
    other = json.dumps(kept | {"found_out_by": "another version"})
    for text in (other, "", "{", "[]", "{}", '{"found_out_by": 1}', None):
        memory.unlink() if text is None else memory.write_text(text)
        assert Codes(memory).of(module) == found


def test_codes_keep_nothing_without_room(tmp_path, module, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    codes = Codes(tmp_path / "kept.json")
    codes.of(module)
    monkeypatch.setattr(os, "replace", full)
    codes.keep()
    assert os.listdir(tmp_path) == ["module.py"]


# -- what is left out of the project's own code ----------------------------------------------------

LOGGER = "import logging\nlogger = logging.getLogger(__name__)\n"
LOGS = LOGGER + "def f(rows, counts):\n    {}\n    return rows, counts\n"
FAILS = "def f(rows, counts):\n    {}\n"
CAUGHT = "def f():\n    {}\ntry:\n    f()\nexcept ValueError as error:\n    %s\n"
CLASS = "class A:\n    {}\n    x = 1\n"
# Frames, and what may stand in each, a line of code each: words, which only people read.
WORDS = {
    LOGS: """logger.info('a %s', rows) | logger.info('b') | logger.error('no %s', rows.shape[0])
        logger.info('%s', type(rows).__name__) | pass""",
    FAILS: """raise KeyError('a') | raise KeyError('b') | raise KeyError(f'{rows} is negative')
        raise KeyError(f'{rows:.3g} of {len(counts)} is', 'negative')""",
    "def f(error):\n    {} from error": "raise KeyError('a') | raise KeyError('b')",
    "{}\nx = 1": "'What it does' | 'Something else' | pass",
    CLASS: "'A thing' | 'Another' | pass",
    "class A:\n    x: float = 1.0\n    {}": "'Its size' | 'Its length' | pass",
    "def f():\n    {}\n    return 1": "'What it does' | 'Something else' | pass",
    "{}": """def __getattr__(name): return 1 | def __getattr__(name): raise AttributeError(name)
        def __dir__(): return ['a']""",
}
# What does different things: the digests differ, or `words_read` or `offered_late` refuse one.
MATTERS = {
    # errors of the project, with a value, or made by a call; what is called in their texts
    FAILS: """raise Stop(1) | raise Stop(2) | raise Stop('a') | raise Stop('b') | raise KeyError('')
        raise SystemExit(1) | raise SystemExit(2) | raise StopIteration(rows) | raise | pass
        raise StopIteration(counts) | raise made('type') | raise made('value') | return KeyError()
        raise ERRORS['a']('x') | raise ERRORS['b']('x') | raise OSError(2, 'a') | raise TypeError()
        raise OSError(5, 'a') | raise KeyError('a') from rows.pop() | raise KeyError(f'{(x := 1)}')
        raise KeyError(f'{rows.pop()}') | raise KeyError(f'{list(rows)}') | raise KeyError(rows)""",
    # more than names in the log
    LOGS: """logger.info('%s', rows.pop()) | logger.info('%s', next(rows)) | pass
        logger.info('%s', list(rows)) | logger.info(', '.join(rows)) | logger.info(f'{counts[0]}')
        logger.info('%s', [row for row in rows]) | logger.info('%s', (yield 1))
        logger.info('%s', *rows) | logger.info('', extra=rows.pop()) | len = rows.remove
        logger.info('%s', rows := 1) | logger.info('%s', rows := 2) | logger.addHandler(rows)
        len = rows.remove; logger.info('%s', len(1)) | logger.info('%s', type('A', rows))
        print('%s', rows) | rows = logger.info('a') | other.info('a')
        logger.info('%s', float(rows))""",
    CLASS: """def __repr__(self): return 1 | def __repr__(self): return 2 | pass
        def __str__(self): return 1 | def __getattr__(self, name): return 1""",
    "class A:\n    {}\n    def f(self): return ''": "@register | @other | pass",
    "{}": "def __repr__(): return 1 | def __repr__(): return 2 | pass",
}
# Frames whose words are read, or whose late offers; a logger that does more than log
READ = {
    "raise ValueError('1') | raise ValueError('2')": [
        *(CAUGHT % "return str(error)", CAUGHT % "return error.args"),
        *(CAUGHT % "return sys.exc_info()[1]", CAUGHT % "raise Stop(error.args[0])"),
        *(CAUGHT % "raise (A if '1' in str(error) else B)('x')", CAUGHT % "return h().__cause__"),
        "class ValueError(E): ...\n{}",
        "def __exit__(self, kind, error, place):\n    self.text = str(error)\n" + FAILS,
        "from traceback import format_exc\n" + FAILS,
    ],
    "logger.info('a') | logger.info('b')": [
        *(LOGS + "logging.getLogger().addHandler(H())", LOGS + "class H(logging.Handler): ..."),
        *("from logging import Filter\n" + LOGS, LOGS + "other.logger = Recorder()\n"),
        *("logger = Recorder()\n{}", LOGGER + "logger = Recorder()\n{}"),
        *(LOGGER + "globals()['logger'] = R()\n{}", LOGS.replace("logging.g", "recorder.g")),
        *("def f(logger):\n    {}", "import recorder as logging\n" + LOGS),
    ],
    "'a' | 'b'": [
        *("{}\nTEXT = __doc__", "{}\nTEXT = A.__doc__", "{}\nTEXT = inspect.getdoc(A)"),
        *("{}\nfrom ast import get_docstring", "from package import VALUE\n{}"),
        *("import package\nx = package.VALUE\n{}", "import package as p\nx = p.VALUE\n{}"),
        "import package\nx = getattr(package, 'x')\n{}",
    ],
}


def digest_of(source, strict=False):
    source = source if isinstance(source, bytes) else source.encode()
    return parsed(source, "module.py", strict=strict).digest


def filled(frame, bodies):
    return [frame.replace("{}", body.strip(), 1) for body in re.split(r" \| |\n", bodies)]


@pytest.fixture
def package(tmp_path):
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "module.py").write_text("")
    return tmp_path / "package"


@pytest.mark.parametrize(("frame", "bodies"), WORDS.items())
def test_words_count_nothing_but_in_a_users_module(frame, bodies):
    sources = filled(frame, bodies)
    assert len({digest_of(source) for source in sources}) == 1
    assert len({digest_of(source, strict=True) for source in sources}) == len(sources)


@pytest.mark.parametrize(
    ("frame", "bodies"),
    [*MATTERS.items(), *((frame, bodies) for bodies in READ for frame in READ[bodies])],
)
def test_what_is_left_out_cannot_matter(tmp_path, package, frame, bodies):
    path, told = tmp_path / "module.py", []
    for source in filled(frame, bodies):
        path.write_text(source)
        refused = bool(words_read(path) or offered_late(path, package))
        told.append((digest_of(source), refused))
    for (one, one_is_refused), (other, other_is_refused) in combinations(told, 2):
        assert one != other or one_is_refused or other_is_refused


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


# -- what counts -----------------------------------------------------------------------------------


def test_a_digest_is_the_same_in_every_version_of_python():
    # computed with Python 3.11; a version with another syntax tree must not rerun whole campaigns.
    # Python 3.12 has empty text in a nested format specification and fields for type parameters.
    code = """
LIMIT = 10

class Thing:
    size: float = 1.0

    def area(self, factor: float = 2, *, deep=None) -> float:
        if self.size > LIMIT:
            pass
        return f"{factor * self.size ** 2:.3f} {deep!r}"
"""
    code = f"import math\n{code}" + (
        "\ndef show(value, width, formats):\n"
        '    return f"{value:{formats[width]}}" rf"{value!r:>{width}}\\pi" "plain" f"{value=}"\n'
    )
    assert digest_of(code) == "c0ace66b1615"


# Statements of all kinds; one part of them is changed, dropped or moved at a time.
STATEMENTS = """
from __future__ import annotations
import a.b, c as d
from ..e import f as g, h
@a
@b(1)
class C(D, E, x=1, **kinds): y: int = 1
async def f(a, /, b: int, c=1, *d, e, g=2, **h) -> i: await (yield a)
def f(*, a, b=1): return (lambda a, b=1, *c: (yield from a))
def f():
    global x, y
    nonlocal z
    x, *y = z = u
async def f():
    async for a in b: break
    else: c()
    async with d as e, g: return [i async for i in j if k if l]
for a in b: continue
else: c()
while a: b()
else: c()
if a: b()
elif c: d()
else: e()
with a as b, c: d()
try: a()
except B as c: d()
except: e()
else: f()
finally: g()
try: a()
except* B: c()
raise A(1) from b
assert a, 'b'
del a, b[c]
x: int
x: int = 1
x @= 1
x = a[1:2:3, ..., :b], a.b.c, (d := 1), -e, not f, 'g' 'h', b'i', 2j, 3.5
x = a < b < c, a is not b, a and b and c, a - b - c, a if b else c
x = [a, *b], {a, b}, {a: b, **c}, f(a, *b, c=d, **e), {a: b for c, d in e for g in h}
x = f'{a}b{c!r:>{d}.3}', {a for b in c}, (a for b in c)
match a:
    case {'k': 1, **b}: c()
    case [d, *_] | E(f, g=None) as h if i: j()
    case _: k()
"""
VALUES = [0, 1, 1.0, 0.0, 1e999, 1e308, True, None, ..., 1j, "", "a", b"a", "None", "\x1f"]
VALUES += ["\ufb01", "fi", "a\x1fb"]
# What is easily taken for the same, or for another.
MORE = r"""x = -0.0 | x = ['', ''] | x = 'a', 'b' | x = 'a\x1fb' | x = f'{y=}' | x = f'{y =}'
    x = f'{y:}' | (x): int = 1 | x[1:2:]\nx[:1] | a - (b - c) | f(a)(b) | f(b, *a) | f(a=1, b=2)
    f(b=2, a=1) | {None: a} | {**a} | x = 16 | x = 0x1_0 | x = 'ab' | x = 'a' "b" | x = u'a'
    x = r'a' | x = (1 + 2) | x = 1 + \\n  2 | x = 1; y = 2
    x = 1  # type: int | if a:\n  b()\nc() | if a:\n  b()\n  c()"""


def changed(value, kept):
    """Other values of a part of a syntax tree."""
    if isinstance(value, list):
        yield from (value[:place] + value[place + 1 :] for place in range(len(value)))
        yield from (value[::-1], [*value, *value[:1]])
    elif kept == "value" and not isinstance(value, ast.AST):
        yield from VALUES
    elif isinstance(value, ast.operator | ast.unaryop | ast.boolop):
        yield from (kind() for kind in type(value).__base__.__subclasses__())
    elif type(value) is int:
        yield from (value - 1, value + 1)
    else:
        yield from (None, "other", ast.Name("other", ast.Load()))


def variants(statement):
    """Texts of a statement with one part that is another."""
    for node in ast.walk(statement):
        for name, value in ast.iter_fields(node):
            for other in changed(value, name if isinstance(node, ast.Constant) else ""):
                setattr(node, name, other)
                with suppress(Exception):  # not all can be written
                    yield ast.unparse(ast.fix_missing_locations(statement))
            setattr(node, name, value)


@pytest.fixture(scope="module")
def sources():
    """Sources, whose syntax trees tell which of them do the same."""
    texts = [text.replace("\\n", "\n") for text in filled("{}", MORE)]
    found = {text: ast.dump(ast.parse(text)).replace(", kind='u'", "") for text in texts}
    for statement in ast.parse(STATEMENTS).body:
        for text in (ast.unparse(statement), *variants(statement)):
            with suppress(SyntaxError, ValueError):
                found[text] = ast.dump(ast.parse(text))
    return found


@pytest.mark.parametrize("strict", [False, True])
def test_parsed_sources_that_do_the_same_have_one_digest_and_no_others(sources, strict):
    assert len(sources) > 1000
    same = {tree: digest_of(text, strict) for text, tree in sources.items()}
    assert [text for text, tree in sources.items() if digest_of(text, strict) != same[tree]] == []
    assert len({*same.values()}) == len(same)
    for path in Path(code_hash.__file__).parent.glob("*.py"):  # in another layout
        text = path.read_text(encoding="utf-8")
        assert digest_of(ast.unparse(ast.parse(text)), strict) == digest_of(text, strict)
    encoded = [f"# coding: {name}\nx = '".encode() + b"\xe9'" for name in ("latin-1", "cp1251")]
    assert digest_of(encoded[0], strict) == digest_of("x = '\xe9'", strict)
    assert digest_of(encoded[1], strict) != digest_of(encoded[0], strict)
    for one, other in (("\ufb01 = 1", "fi = 1"), ("x = 1\r\ny = 2\r\n", "x = 1; y = 2")):
        assert digest_of(one, strict) == digest_of(other, strict)


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

UNSEEN = r"""exec(text) | eval(text) | run = exec | import runpy; runpy.run_path(name)
    from pkgutil import iter_modules | __import__(name) | importlib.import_module(name)
    here = Path(__file__).parent | sys.path.insert(0, place) | importlib.resources.files(package)
    from importlib.resources import files | snakemake.config['low'] | value = snakemake.config
    getattr(snakemake, name) | os.environ['LOW'] | os.getenv('LOW') | environ.get('LOW')
    open('low.txt') | Path('low.txt').read_text() | Path('low.txt').open() | np.load('low.npy')
    pd.read_csv('low.csv') | xr.open_dataset('low.nc') | subprocess.run([sys.executable, name])
    os.system('python low.py')"""
SEEN = """import_module('json') | re.compile(text) | frame.eval(text) | model.eval()
    open(snakemake.input[0]) | Path(snakemake.input['low']).read_text() | open('low.txt', 'w')
    Path('low.txt').open('w') | open('low.txt', mode='wb') | os.environ['LOW'] = '1'
    os.environ.setdefault('LOW', '1') | pd.read_csv(path) | subprocess.run(['bcftools', path])
    snakemake.params.low | print(__doc__) | zipfile.ZipFile(snakemake.input[0]).open('member')
    run(python)"""


@pytest.mark.parametrize(
    ("code", "seen"),
    [(code, codes is SEEN) for codes in (UNSEEN, SEEN) for code in filled("{}", codes)],
)
def test_parsed_tells_what_is_not_seen_by_its_line(code, seen):
    places = parsed(f"\n{code}\n".encode(), "a.py", strict=True).unseen
    assert places == [] if seen else places[-1].startswith("line 2: ")
