"""What owns PETSc objects is closed by its maker: by ``with``, or by ``close`` where it outlives one."""

from abc import ABC, abstractmethod
from typing import Self


class Closing(ABC):
    """A context manager that ends with ``close``."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    @abstractmethod
    def close(self) -> None:
        """Destroy the PETSc objects, once. Collective."""
