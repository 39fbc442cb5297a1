# %% [markdown]
# # One crack from Python
#
# A notch in undeformed pearlite under a constant Delta-K. The crack is followed step by step and
# then seen as a whole: its way through the colonies, its length over the cycles, and the rate from
# one advance to the next beside that of the whole extension.
#
# | parameter | value |
# |---|---|
# | state | undeformed, mesh 0 |
# | Delta-K | 18 MPa sqrt(m) |
# | extension | 40 um |
# | all else | as in the quickstart |
#
# `python docs/examples/one_crack.py` writes `one_crack.png`; `mpirun -n 2 python ...` lets two
# ranks share the crack. Editors that know `# %%` open the file as a notebook.

# %%
import numpy as np
from matplotlib import pyplot as plt
from mpi4py import MPI

import pearlite_petsc as pp

scene = pp.Scene("one_crack", loading={"extension_um": 40.0})
mesh = pp.build_mesh(scene, "undeformed", index=0)

# %% [markdown]
# A mesh knows what it is made of. The areas of its elements add up to the window, and the share of
# interfaces that cut lamellae says how often a crack meets cementite.

# %%
kinds, counts = np.unique(mesh.interfaces.kind, return_counts=True)
shares = dict(zip(kinds.tolist(), (counts / counts.sum()).round(3).tolist(), strict=True))
assert np.isclose(mesh.elements.area_um2.sum(), np.prod(mesh.window_um))

# %% [markdown]
# `Growth` yields a step after every block of cycles. Here the longest wait between two advances is
# looked for on the way; `growth.crack()` gives the crack at any time.

# %%
longest, last_cycles, last_length = 0.0, 0.0, mesh.notch_um[0]
with pp.Growth(mesh, delta_k_mpa_sqrt_m=18.0) as growth:
    for step in growth:
        if step.crack_length_um > last_length:
            longest = max(longest, step.cycles - last_cycles)
            last_cycles, last_length = step.cycles, step.crack_length_um
crack = growth.crack()
assert crack.stop_reason == "grown"

# %% [markdown]
# `crack.history` has a row for every break, `crack.rates` one for every moment at which the crack
# got longer. `crack.da_dn_m_per_cycle` is the least-squares slope through the latter. From one of
# them to the next (secant) the rate scatters over decades, because the crack waits at cementite and
# boundaries and then jumps; the parabola through seven of them smooths that.

# %%
rates = crack.rates
figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13.0, 4.8), layout="constrained")
crack.plot(ax=left)
crack.plot_history(ax=middle)
right.semilogy(rates.crack_length_um, rates.secant_m_per_cycle, "o", label="secant")
right.semilogy(
    rates.crack_length_um, rates.polynomial_m_per_cycle, "s-", label="parabola through seven"
)
right.axhline(crack.da_dn_m_per_cycle, color="black", linestyle="--", label="whole extension")
right.set(xlabel="crack length a [µm]", ylabel="da/dN [m/cycle]")
right.grid(True, color="#e6e6e6")
right.legend(fontsize=7.5)

if MPI.COMM_WORLD.rank == 0:
    figure.savefig("one_crack.png", dpi=80)
    print(mesh, shares, crack, f"longest wait: {longest:.0f} cycles", sep="\n")
