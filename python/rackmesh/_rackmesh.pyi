"""The extension module; the package has the same names."""

import os
from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal

from ._types import Answer

__version__: str

def main(arguments: Sequence[str]) -> int:
    """Runs the command line with these arguments, the first of which is its name; returns the exit status."""

def compare(*specs: Spec, **options: Any) -> Answer:
    """Specs side by side, each with its own settings: ``rackmesh compare`` with the same options.

    ``differences`` has each ``key`` with its ``values``, ``results`` the results with ``values`` and ``changes``.
    """

class Spec:
    """A gear spec: TOML text, and keys that are set in place of those of the text. It does not change; ``set`` returns
    another one.

    The keys, their units and domains are those of ``rackmesh explain keys``. A wrong spec raises ``RackmeshError``.
    """

    name: str
    text: str

    @classmethod
    def from_toml(cls, text: str, name: str = "spec.toml") -> Spec:
        """A spec from its text. Messages call it ``name``; paths of tables in it are relative to the folder of ``name``."""

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
        """ΔCD of each error, in mm, combined and judged: ``rackmesh eval`` with the same options."""

    def mesh(
        self,
        from_mm: float | None = None,
        to_mm: float | None = None,
        *,
        measured: str | PathLike[str] | tuple[Iterable[float], Iterable[float]] | None = None,
        **options: Any,
    ) -> Answer:
        """ΔCD along the stroke by the exact mesh, in mm: ``rackmesh mesh`` with the same options.

        ``measured`` is a measured curve to lay on the computed one: the path of a table, or strokes and ΔCD in mm.
        ``diagnose=True, noise="1 um"`` names the teeth whose errors explain it: ``answer["diagnosis"]``.
        """

    def simulate(self, **options: Any) -> Answer:
        """ΔCD along the stroke with elastic teeth and forces, in mm and N: ``rackmesh simulate`` with the same options."""

    def monte_carlo(
        self, racks: int | None = None, from_mm: float | None = None, to_mm: float | None = None, **options: Any
    ) -> Answer:
        """Random racks, each through the exact mesh, in mm: ``rackmesh monte-carlo`` with the same options.

        ``first_rack=N, racks=M, study="range.json"`` writes the result of a range of racks; ``merge=["a.json", "b.json"]``
        combines ranges, with the same bits as one run. ``contributions=True`` adds the share of each scatter in the variance:
        ``answer.array("contributions", "indices")`` has a numpy array for each number.
        """

    def budget(self, **options: Any) -> Answer:
        """Tolerances from a limit, in mm and degrees: ``rackmesh budget`` with the same options."""

    def sweep(
        self,
        over: Mapping[str, str | Iterable[object]],
        of: Literal["eval", "mesh", "simulate", "class", "budget"] = "eval",
        *,
        columns: Sequence[str] | None = None,
        arguments: Sequence[str] | None = None,
        **options: Any,
    ) -> Answer:
        """The answer of a command about every design: ``rackmesh sweep`` with its options (``samples``, ``seed``, ``until``).

        ``over`` has the values of each key: a list, or a text such as ``"18..25:0.5"``; ``arguments`` are those of the
        command. The rows are ``answer.table``, an Arrow record batch: ``pyarrow.record_batch(answer.table)``,
        ``polars.DataFrame(answer.table)``; ``answer.array("table")`` has a numpy array for each column.
        """

class Plan:
    """Judges tables of parts as ``rackmesh batch`` does.

    Columns are found, and refused, by the rules for all tables. ``ignore`` leaves out columns by name (``*`` for any
    characters). ``partial`` judges without errors that the spec asks for and the table lacks, and names them in a column
    ``judged_without``. ``columns`` names the columns of the result; without it, the result has all. Results are in mm, with
    all digits.
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
        """Judges the parts of a record batch or a table with Arrow's C interface; one row for each, in their order.

        ``verdict`` is pass, fail, indeterminate or null, and ``reason`` says why it is not a pass. For pyarrow data the result
        is pyarrow's, for polars data polars'; for other data it is an object with Arrow's C interface. Columns that are not
        understood raise ``RackmeshError``.
        """

    def schema(self, data: Any) -> Any:
        """The schema of the result of ``evaluate`` for such data: a record batch, a table or a schema."""
