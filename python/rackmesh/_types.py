"""The types that the extension module returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from ._rackmesh import Plan, Spec


class Place(NamedTuple):
    """The place of a problem in a file; line and column count from 1."""

    file: str
    line: int
    column: int


class Diagnostic(NamedTuple):
    """What is wrong, where, and what to do."""

    code: str
    message: str
    place: Place | None
    remedy: str | None

    def __str__(self) -> str:
        where = f"{self.place.file}:{self.place.line}:{self.place.column}: " if self.place else ""
        remedy = f"; {self.remedy}" if self.remedy else ""
        return f"{where}{self.message}{remedy} [{self.code}]"


class RackmeshError(ValueError):
    """Why there is no result: one diagnostic, or several of the same call."""

    def __init__(self, diagnostics: list[Diagnostic]) -> None:
        super().__init__(diagnostics)
        self.diagnostics = diagnostics

    def __str__(self) -> str:
        return "\n".join(map(str, self.diagnostics))

    @property
    def code(self) -> str:
        """The code of the first problem; ``rackmesh explain CODE`` explains it."""
        return self.diagnostics[0].code

    @property
    def message(self) -> str:
        """What is wrong, of the first problem."""
        return self.diagnostics[0].message

    @property
    def place(self) -> Place | None:
        """The place of the first problem, if it is in a file."""
        return self.diagnostics[0].place

    @property
    def remedy(self) -> str | None:
        """What to do about the first problem."""
        return self.diagnostics[0].remedy


@dataclass(frozen=True)
class Answer:
    """The answer of a command about a spec.

    ``answer["verdict"]`` is a key of the result, ``answer.array("points_mm")`` a list of numbers as a numpy array. A notebook
    shows the tables and, if the command draws one, the picture ``svg``. ``table`` has the rows of ``sweep`` as Arrow data.
    """

    command: str
    result: dict[str, Any]
    markdown: str
    svg: str | None
    warnings: list[Diagnostic]
    remarks: list[str]
    status: int
    table: Any = None

    def to_dict(self) -> dict[str, Any]:
        """The result, as the command writes it with ``--format json``."""
        return self.result

    def __getitem__(self, key: str) -> Any:
        return self.result[key]

    def array(self, *keys: str) -> Any:
        """The value below these keys as a numpy array; of records or of ``"table"``, one array per column."""
        import numpy

        if keys == ("table",):
            import pyarrow

            columns = pyarrow.record_batch(self.table)
            return {name: columns.column(name).to_numpy(zero_copy_only=False) for name in columns.schema.names}
        value: Any = self.result
        for key in keys:
            value = value[key]
        if value and isinstance(value[0], dict):
            return {key: numpy.asarray([record[key] for record in value]) for key in value[0]}
        return numpy.asarray(value)

    def _ipython_display_(self) -> None:
        from IPython.display import SVG, Markdown, display

        display(Markdown(self.markdown))
        if self.svg is not None:
            display(SVG(self.svg))

    def _repr_markdown_(self) -> str:
        return self.markdown

    def __str__(self) -> str:
        return self.markdown


def spec_again(text: str, name: str, settings: list[str]) -> Spec:
    """Restores a pickled spec."""
    return Spec._again(text, name, settings)


def plan_again(
    spec: Spec,
    columns: list[str] | None,
    stack: str,
    rule: str | None,
    model: str,
    ignore: list[str],
    partial: bool,
    threads: int,
) -> Plan:
    """Restores a pickled plan."""
    return Plan(
        spec, columns=columns, stack=stack, rule=rule, model=model, ignore=ignore, partial=partial, threads=threads
    )
