"""The extension module; its names are those of the package."""

import os
from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal

from ._types import Answer

__version__: str

def main(arguments: Sequence[str]) -> int:
    """Runs the command line with these arguments, the first of which is its name; the exit status."""

def compare(*specs: Spec, **options: Any) -> Answer:
    """Specs side by side, each with what is set in it: ``rackmesh compare`` with the same options.

    ``differences`` has the keys with their ``values``, ``results`` what that does.
    """

class Spec:
    """A gear spec: TOML, with keys set in place of what the text says. Does not change; ``set`` gives another one.

    The keys, their units and domains are those of ``rackmesh explain keys``. What is wrong with a spec is a
    ``RackmeshError``.
    """

    name: str
    text: str

    @classmethod
    def from_toml(cls, text: str, name: str = "spec.toml") -> Spec:
        """A spec from its text; messages call it ``name``, and the tables that it names are beside that."""

    @classmethod
    def from_file(cls, path: str | os.PathLike[str]) -> Spec:
        """A spec from a file; ``OSError`` if it cannot be read."""

    def set(self, key: str, value: object) -> Spec:
        """The same spec with a key set: ``spec.set("errors.rack_pitch", "12 um")``."""

    def evaluate(
        self,
        *,
        stack: Literal["range", "rss"] = ...,
        model: Literal["exact", "paper"] = ...,
        rule: str = ...,
        mesh: bool = ...,
        no_worst_teeth: bool = ...,
        monte_carlo: int = ...,
        seed: int = ...,
        digits: int = ...,
    ) -> Answer:
        """ΔCD of each error, combined and judged (mm): ``rackmesh eval`` with the same options."""

    def mesh(
        self,
        from_mm: float | None = None,
        to_mm: float | None = None,
        *,
        measured: str | PathLike[str] | tuple[Iterable[float], Iterable[float]] | None = None,
        **options: Any,
    ) -> Answer:
        """ΔCD along the stroke by the exact mesh (mm): ``rackmesh mesh`` with the same options.

        ``measured`` lays a measured curve on the computed one: the path of a table, or strokes and ΔCD in mm.
        ``diagnose=True, noise="1 um"`` names the teeth whose errors explain it: ``answer["diagnosis"]``.
        """

    def simulate(self, **options: Any) -> Answer:
        """ΔCD along the stroke with elastic teeth and forces (mm, N): ``rackmesh simulate`` with the same options."""

    def monte_carlo(
        self, racks: int | None = None, from_mm: float | None = None, to_mm: float | None = None, **options: Any
    ) -> Answer:
        """Random racks, each through the exact mesh (mm): ``rackmesh monte-carlo`` with the same options.

        ``first_rack=N, racks=M, study="range.json"`` keeps what a range came to; ``merge=["a.json", "b.json"]`` puts ranges
        together, with the bits of one run. ``contributions=True`` adds which scatter makes which share of the variance:
        ``answer.array("contributions", "indices")`` has a numpy array for each number.
        """

    def budget(self, **options: Any) -> Answer:
        """Tolerances from a limit (mm, degrees): ``rackmesh budget`` with the same options."""

    def sweep(
        self,
        over: Mapping[str, str | Iterable[object]],
        of: Literal["eval", "mesh", "simulate", "class", "budget"] = "eval",
        *,
        columns: Sequence[str] | None = None,
        arguments: Sequence[str] | None = None,
        **options: Any,
    ) -> Answer:
        """What a command says of every design: ``rackmesh sweep`` with the same options (``samples``, ``seed``, ``until``).

        ``over`` has the values of each key: a list, or a text such as ``"18..25:0.5"``; ``arguments`` are those of the
        command. The rows are ``answer.table``, an Arrow record batch: ``pyarrow.record_batch(answer.table)``,
        ``polars.DataFrame(answer.table)``; ``answer.array("table")`` has a numpy array for each column.
        """

class Plan:
    """Judges tables of parts as ``rackmesh batch`` does.

    Columns are found, and refused, by the rules for any table; ``ignore`` leaves out columns by name (``*`` for any
    characters), ``partial`` judges without errors that the spec asks for and the table lacks, and says so in a column
    ``judged_without``. ``columns`` are those to give, by name; all results without it. Results are in mm, with all their
    digits.
    """

    def __init__(
        self,
        spec: Spec,
        *,
        columns: Sequence[str] | None = None,
        stack: Literal["range", "worst", "rss"] = "range",
        rule: str | None = None,
        model: Literal["exact", "paper"] = "exact",
        ignore: Sequence[str] = (),
        partial: bool = False,
        threads: int = 1,
    ) -> None: ...
    def evaluate(self, data: Any) -> Any:
        """Judges the parts of a record batch or a table with Arrow's C interface: as many rows, in their order.

        ``verdict`` is pass, fail, indeterminate or null, and ``reason`` says why a row has none. pyarrow gives pyarrow,
        polars gives polars; of other libraries comes an object with the same interface. Columns that are not understood
        raise ``RackmeshError``.
        """

    def schema(self, data: Any) -> Any:
        """The schema of what ``evaluate`` gives for such data: a record batch, a table or a schema."""
