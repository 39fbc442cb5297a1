"""A file for HDF5 to write into that never fails under it.

HDF5 cannot close a file whose disk is full, and takes the process down at its end. Here such an
error is kept, the rest goes nowhere, and ``check`` raises it.
"""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py


class SafeStream(io.RawIOBase):
    """Binary file, written and read, that keeps its first error.

    Args:
        path: The file, made anew.

    Raises:
        OSError: It cannot be opened.
    """

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._path = path
        self._file = path.open("w+b", buffering=0)
        self._place = 0
        self._error: OSError | None = None

    def check(self) -> None:
        """Raise the error that a write met, if there was one."""
        if self._error is not None:
            raise OSError(self._error.errno, self._error.strerror, str(self._path))

    def write(self, data: Any) -> int:
        """Write all bytes at the current place; after an error nowhere."""
        view = memoryview(data).cast("B")
        written = 0
        try:
            while self._error is None and written < len(view):
                self._file.seek(self._place + written)
                written += self._file.write(view[written:]) or 0
        except OSError as error:
            self._error = error
        self._place += len(view)
        return len(view)

    def readinto(self, buffer: Any) -> int:
        """Fill the buffer from the current place; what was never written is 0."""
        view = memoryview(buffer).cast("B")
        self._file.seek(self._place)
        count = self._file.readinto(view) or 0
        if self._error is not None:
            view[count:] = bytes(len(view) - count)
            count = len(view)
        self._place += count
        return count

    def seek(self, place: int, whence: int = io.SEEK_SET) -> int:
        """Go to a place and return it."""
        start = {io.SEEK_SET: 0, io.SEEK_CUR: self._place}.get(whence)
        self._place = place + (self._file.seek(0, io.SEEK_END) if start is None else start)
        return self._place

    def tell(self) -> int:
        """Return the current place."""
        return self._place

    def truncate(self, size: int | None = None) -> int:
        """Give the file a size and return it."""
        size = self._place if size is None else size
        try:
            if self._error is None:
                self._file.truncate(size)
        except OSError as error:
            self._error = error
        return size

    def flush(self) -> None:
        """Nothing is held back."""

    def close(self) -> None:
        """Close the file."""
        if not self.closed:
            self._file.close()
        super().close()

    def readable(self) -> bool:
        """True."""
        return True

    def writable(self) -> bool:
        """True."""
        return True

    def seekable(self) -> bool:
        """True."""
        return True


@contextmanager
def hdf5_file(path: Path) -> Iterator[Any]:
    """Yield a new HDF5 file to write into.

    Raises:
        OSError: It cannot be written; at the end at the latest.
    """
    stream = SafeStream(path)
    try:
        with h5py.File(stream, "w") as file:
            yield file
        stream.check()
    finally:
        stream.close()
