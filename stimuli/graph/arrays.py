"""Names of the arrays that the graph's compiled loops work on."""

import numpy as np
import numpy.typing as npt

Indices = npt.NDArray[np.int32]  # clips, frames and nodes as they are kept
Rows = npt.NDArray[np.int64]  # places in arrays
Flags = npt.NDArray[np.bool_]
Complex = npt.NDArray[np.complex128]  # places and turns on the floor, z + ix
