"""How far manufacturing errors move the operating centre distance (ΔCD) of a rack and pinion.

A ``Spec`` is a gear spec, as the command line takes it from a file; its methods give the answers of the commands. A
``Plan`` judges tables of parts in Arrow data: pyarrow, polars, or any object with Arrow's C interface.
"""

from ._rackmesh import Plan, __version__, compare
from ._types import Answer, Diagnostic, Place, RackmeshError, Spec

__all__ = ["Answer", "Diagnostic", "Place", "Plan", "RackmeshError", "Spec", "__version__", "compare"]
