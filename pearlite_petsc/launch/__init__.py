"""The start of a run on several ranks, and what its user sees of it. Knows neither MPI nor numpy.

``pearlite run --ranks 4`` is one process, the launcher: it starts ``mpirun``, shows lines and a bar
on the terminal that it owns, hands signals on to the ranks and turns their end into the documented
exit status. The ranks report through a channel, because what they print arrives differently with
every MPI (Open MPI 5 forwards whole lines only).
"""
