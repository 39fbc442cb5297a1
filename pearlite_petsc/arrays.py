"""Array types shared by all layers; the first axis is the thing (element, interface, vertex)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Return the array with its write flag cleared (the array itself, not a copy)."""
    array.setflags(write=False)
    return array


def guarded(array: NDArray[Any]) -> NDArray[Any]:
    """Return a view of the array that cannot be written through."""
    return read_only(array.view())
