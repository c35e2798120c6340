"""How far manufacturing errors move the operating centre distance (ΔCD) of a rack and pinion.

A ``Spec`` is what the command line takes as a file; its methods give what the commands say. A ``Plan`` judges tables of
parts that are Arrow data: pyarrow, polars, or anything else with Arrow's C interface.
"""

from ._rackmesh import Plan, __version__, compare
from ._types import Answer, Diagnostic, Place, RackmeshError, Spec

__all__ = ["Answer", "Diagnostic", "Place", "Plan", "RackmeshError", "Spec", "__version__", "compare"]
