"""Functions written in LLVM's intermediate language and compiled to machine code.

Instructions work on vectors, with one number (a lane) for each of several trajectories that are
adjacent in memory. They are carried out as written, in order, each rounded as IEEE 754 requires:
results have the same bits on every processor. Compilation takes some hundredths of a second in each
process; nothing is cached on disk.
"""

import ctypes
import struct
from collections.abc import Callable, Sequence

ALIGNMENT = 64
"""Bytes to which vectors in memory are aligned: a cache line."""


class Lanes:
    """Text of a function that works on vectors of ``width`` numbers.

    Values are LLVM's names for them (``%v12``), or numbers; integers have 64 bits.
    """

    def __init__(
        self, width: int, name: str, pointers: Sequence[str], integers: Sequence[str]
    ) -> None:
        self.width, self.name = width, name
        self.vector = f"<{width} x double>"
        self._alignment = min(ALIGNMENT, 8 * width)
        self.arguments = (len(pointers), len(integers))
        arguments = [f"ptr %{name}" for name in pointers] + [f"i64 %{name}" for name in integers]
        fused = f"llvm.fma.v{width}f64"
        self._lines = [
            f"declare {self.vector} @{fused}({', '.join([self.vector] * 3)})",
            f"declare {self.vector} @llvm.sqrt.v{width}f64({self.vector})",
            "declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)",
            "declare i64 @llvm.smin.i64(i64, i64)",
            f"define void @{name}({', '.join(arguments)}) {{",
            "entry:",
        ]
        self._block = "entry"
        self._names = 0

    @property
    def text(self) -> str:
        """The whole program."""
        return "\n".join([*self._lines, "  ret void", "}", ""])

    def _add(self, instruction: str) -> str:
        name = self._name()
        self._lines.append(f"  {name} = {instruction}")
        return name

    def _name(self) -> str:
        self._names += 1
        return f"%v{self._names}"

    def _begin(self, block: str) -> None:
        self._lines.append(f"{block}:")
        self._block = block

    # -- integers, pointers, memory ---------------------------------------------------------------

    def plus(self, m: str, n: str | int) -> str:
        """Sum of two integers."""
        return self._add(f"add i64 {m}, {n}")

    def times(self, m: str, n: str | int) -> str:
        """Product of two integers."""
        return self._add(f"mul i64 {m}, {n}")

    def smaller(self, m: str, n: str) -> str:
        """Smaller of two integers."""
        return self._add(f"call i64 @llvm.smin.i64(i64 {m}, i64 {n})")

    def integer_at(self, array: str, index: str) -> str:
        """Entry of an array of integers of 32 bits."""
        short = self._add(f"load i32, ptr {self._place(array, 'i32', index)}")
        return self._add(f"sext i32 {short} to i64")

    def number_at(self, array: str, index: str) -> str:
        """Address of an entry of an array of numbers."""
        return self._place(array, "double", index)

    def copy(self, target: str, source: str, size: str) -> None:
        """Copy ``size`` bytes from one address to another."""
        self._lines.append(
            f"  call void @llvm.memcpy.p0.p0.i64(ptr {target}, ptr {source}, i64 {size}, i1 false)"
        )

    def vector_at(self, array: str, index: str) -> str:
        """Address of a vector of an aligned array of vectors."""
        return self._place(array, self.vector, index)

    def load(self, array: str, index: str) -> str:
        """Vector of an aligned array of vectors."""
        place = self.vector_at(array, index)
        return self._add(f"load {self.vector}, ptr {place}, align {self._alignment}")

    def store(self, array: str, index: str, vector: str) -> None:
        """Store a vector at this index of an aligned array of vectors."""
        place = self.vector_at(array, index)
        self._lines.append(f"  store {self.vector} {vector}, ptr {place}, align {self._alignment}")

    def load_row(self, address: str) -> str:
        """Adjacent numbers of an array of numbers, from an address on."""
        return self._add(f"load {self.vector}, ptr {address}, align 8")

    def store_row(self, address: str, vector: str) -> None:
        """Store adjacent numbers of an array of numbers, from an address on."""
        self._lines.append(f"  store {self.vector} {vector}, ptr {address}, align 8")

    def load_bytes(self, array: str, index: str) -> str:
        """Vector of adjacent bytes of an array."""
        return self._add(
            f"load <{self.width} x i8>, ptr {self._place(array, 'i8', index)}, align 1"
        )

    def room(self, vectors: int) -> str:
        """Address of an aligned array of vectors; only before any loop."""
        return self._add(f"alloca {self.vector}, i64 {vectors}, align {self._alignment}")

    def _place(self, array: str, kind: str, index: str) -> str:
        return self._add(f"getelementptr {kind}, ptr {array}, i64 {index}")

    # -- vectors ----------------------------------------------------------------------------------

    def fill(self, number: float) -> str:
        """Vector of equal numbers."""
        return f"<{', '.join([f'double {hexadecimal(number)}'] * self.width)}>"

    def fill_from(self, array: str, index: str) -> str:
        """Vector whose numbers all equal an entry of an array."""
        number = self._add(f"load double, ptr {self.number_at(array, index)}")
        first = self._add(f"insertelement {self.vector} poison, double {number}, i64 0")
        everywhere = f"<{self.width} x i32> zeroinitializer"
        return self._add(f"shufflevector {self.vector} {first}, {self.vector} poison, {everywhere}")

    def add(self, x: str, y: str) -> str:
        """Compute ``x + y``."""
        return self._add(f"fadd {self.vector} {x}, {y}")

    def subtract(self, x: str, y: str) -> str:
        """Compute ``x - y``."""
        return self._add(f"fsub {self.vector} {x}, {y}")

    def multiply(self, x: str, y: str) -> str:
        """Compute ``x * y``."""
        return self._add(f"fmul {self.vector} {x}, {y}")

    def divide(self, x: str, y: str) -> str:
        """Compute ``x / y``."""
        return self._add(f"fdiv {self.vector} {x}, {y}")

    def negate(self, x: str) -> str:
        """Compute ``-x``."""
        return self._add(f"fneg {self.vector} {x}")

    def square_root(self, x: str) -> str:
        """Square root of ``x``."""
        return self._add(f"call {self.vector} @llvm.sqrt.v{self.width}f64({self.vector} {x})")

    def fused(self, x: str, y: str, z: str) -> str:
        """Compute ``x * y + z``, rounded once."""
        operands = ", ".join(f"{self.vector} {operand}" for operand in (x, y, z))
        return self._add(f"call {self.vector} @llvm.fma.v{self.width}f64({operands})")

    def clamp(self, x: str, bound: float) -> str:
        """``x`` limited to [-bound, bound]; NaN stays NaN."""
        for relation, limit in (("ogt", self.fill(bound)), ("olt", self.fill(-bound))):
            beyond = self._add(f"fcmp {relation} {self.vector} {x}, {limit}")
            x = self.select(beyond, limit, x)
        return x

    def maximum(self, x: str, y: str) -> str:
        """Larger of ``x`` and ``y``; NaN where either is."""
        larger = self._add(f"fcmp olt {self.vector} {x}, {y}")
        undefined = self._add(f"fcmp uno {self.vector} {y}, {y}")
        return self.select(self._add(f"or <{self.width} x i1> {larger}, {undefined}"), y, x)

    def select(self, mask: str, x: str, y: str) -> str:
        """``x`` where a mask is true, ``y`` elsewhere."""
        return self._add(f"select <{self.width} x i1> {mask}, {self.vector} {x}, {self.vector} {y}")

    def equal_bytes(self, vector: str, number: int) -> str:
        """Mask of the bytes that equal a number."""
        everywhere = f"<{', '.join([f'i8 {number}'] * self.width)}>"
        return self._add(f"icmp eq <{self.width} x i8> {vector}, {everywhere}")

    # -- branches and loops -----------------------------------------------------------------------

    def when_any(self, mask: str, body: Callable[[], None]) -> None:
        """Append instructions that are skipped where no entry of a mask is true."""
        bits = self._add(f"bitcast <{self.width} x i1> {mask} to i{self.width}")
        condition = self._add(f"icmp ne i{self.width} {bits}, 0")
        self._names += 1
        inside, after = f"inside{self._names}", f"after{self._names}"
        self._lines.append(f"  br i1 {condition}, label %{inside}, label %{after}")
        self._begin(inside)
        body()
        self._lines.append(f"  br label %{after}")
        self._begin(after)

    def loop(
        self,
        start: str,
        stop: str,
        body: Callable[..., Sequence[str] | None],
        carried: Sequence[str] = (),
        *,
        kind: str = "",
        step: int = 1,
    ) -> list[str]:
        """Append ``for index in range(start, stop, step)``; returns the carried values.

        ``body``: Appends the loop's instructions, of the index and the carried values; returns the
        next ones.
        """
        kind = kind or self.vector
        self._names += 1
        inside, after, before = f"loop{self._names}", f"after{self._names}", self._block
        index, values = self._name(), [self._name() for _ in carried]
        enter = self._add(f"icmp slt i64 {start}, {stop}")
        self._lines.append(f"  br i1 {enter}, label %{inside}, label %{after}")
        self._begin(inside)
        place = len(self._lines)  # of the phi instructions, which need the results of the body
        results = list(body(index, *values) or [])
        following = self.plus(index, step)
        more = self._add(f"icmp slt i64 {following}, {stop}")
        self._lines.append(f"  br i1 {more}, label %{inside}, label %{after}")
        last = self._block
        ways = [(index, "i64", start, following)] + [
            (value, kind, initial, result)
            for value, initial, result in zip(values, carried, results, strict=True)
        ]
        self._lines[place:place] = [
            f"  {name} = phi {llvm_type} [ {initial}, %{before} ], [ {result}, %{last} ]"
            for name, llvm_type, initial, result in ways
        ]
        self._begin(after)
        return [
            self._add(f"phi {llvm_type} [ {initial}, %{before} ], [ {result}, %{last} ]")
            for _, llvm_type, initial, result in ways[1:]
        ]


def hexadecimal(number: float) -> str:
    """Text of a number with all its bits, as LLVM reads it."""
    return f"0x{struct.pack('>d', number).hex()}"


def compiled(code: Lanes) -> Callable[..., None]:
    """Compile a function for this processor: of addresses, then of integers; it returns nothing."""
    # imported late: it takes a moment, which commands that compute nothing save
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    module = llvm.parse_assembly(code.text)
    module.verify()
    processor = llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten(), opt=2
    )
    engine = llvm.create_mcjit_compiler(module, processor)
    engine.finalize_object()
    pointers, integers = code.arguments
    types = [ctypes.c_void_p] * pointers + [ctypes.c_int64] * integers
    function = ctypes.CFUNCTYPE(None, *types)(engine.get_function_address(code.name))
    function.engine = engine  # type: ignore[attr-defined] # the code lives as long as the engine
    return function
