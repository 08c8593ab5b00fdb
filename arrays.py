"""Short names for the arrays that the whole project passes around."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Int32s = NDArray[np.int32]
Int16s = NDArray[np.int16]
Float32s = NDArray[np.float32]
