import pytest
from mpi4py import MPI

from pearlite_petsc.errors import MeshError
from pearlite_petsc.growth.ranks import on_first_rank


def test_the_only_rank_gets_its_own_result_and_error() -> None:
    assert on_first_rank(MPI.COMM_SELF, lambda: 7) == 7
    assert on_first_rank(MPI.COMM_SELF, lambda: 7, to_all=True) == 7

    def fails() -> None:
        raise MeshError("no mesh")

    with pytest.raises(MeshError, match="no mesh"):
        on_first_rank(MPI.COMM_SELF, fails)


class Ranks:
    """Rank 0 of a group of two, whose broadcasts are written down."""

    rank, size = 0, 2

    def __init__(self) -> None:
        self.sent: list[object] = []

    def bcast(self, value: object) -> object:
        self.sent.append(value)
        return value


def test_an_error_is_sent_to_the_others_before_it_is_raised() -> None:
    class OddError(Exception):
        """Cannot be pickled: of a function."""

    comm = Ranks()

    def fails() -> None:
        raise OddError("strange")

    with pytest.raises(OddError):
        on_first_rank(comm, fails)  # type: ignore[arg-type]
    (sent,) = comm.sent
    assert str(sent) == "OddError: strange"


def test_a_result_is_sent_only_where_it_is_to_be_shared() -> None:
    comm = Ranks()
    assert on_first_rank(comm, lambda: 5) == 5  # type: ignore[arg-type]
    assert comm.sent == [None]
    assert on_first_rank(comm, lambda: 6, to_all=True) == 6  # type: ignore[arg-type]
    assert comm.sent == [None, None, 6]
