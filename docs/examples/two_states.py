# %% [markdown]
# # A state compared with another
#
# Does severe shear along the crack make it grow faster than in undeformed pearlite, and by how much
# more than the microstructure makes one crack differ from the next? Both states are grown on the
# same number of meshes; meshes are independent, so that their logarithmic rates can be compared by
# Welch's test.
#
# | parameter | value |
# |---|---|
# | states | undeformed, severe A-T |
# | meshes | 4 each |
# | Delta-K | 14 and 20 MPa sqrt(m) |
# | extension | 20 um |
# | all else | as in the quickstart |
#
# `python docs/examples/two_states.py` leaves the run in `runs/two_states/` and writes
# `two_states.png`; `mpirun -n 2 python ...` shares the cracks out among two ranks.

# %%
import numpy as np
from matplotlib import pyplot as plt
from mpi4py import MPI
from scipy.stats import ttest_ind

import pearlite_petsc as pp

LEVELS = (14.0, 20.0)
scene = pp.Scene(
    "two_states",
    states={"undeformed": {}, "severe_AT": {}},
    loading={"delta_k_mpa_sqrt_m": LEVELS, "extension_um": 20.0},
    ensemble={"meshes": 4},
    output={"fields": "none", "figures": False},
)
results = pp.run(scene, overwrite=True)

# %% [markdown]
# Each row of `cracks()` is one crack. Rates are lognormal as far as anybody can tell from few
# meshes: means are geometric, the scatter is a factor.

# %%
cracks = results.cracks()
assert (cracks.stop_reason == "grown").all()
comparison = []
for level in LEVELS:
    at = cracks.delta_k_mpa_sqrt_m == level
    slow, fast = (
        np.log(cracks.da_dn_m_per_cycle[at & (cracks.state == state)]) for state in scene.states
    )
    ratio = np.exp(fast.mean() - slow.mean())
    chance = ttest_ind(fast, slow, equal_var=False).pvalue
    comparison.append(f"{level:g} MPa sqrt(m): {ratio:.1f} times as fast, p = {chance:.2g}")

# %% [markdown]
# The picture of the rates shows means with their scatter and every crack; the paths show why:
# sheared steel lets the crack run straight along its lamellae.

# %%
figure, axes = plt.subplots(1, 3, figsize=(13.0, 4.8), layout="constrained")
results.plot(ax=axes[0])
for state, panel in zip(scene.states, axes[1:], strict=True):
    results.crack(state, 0, delta_k_mpa_sqrt_m=LEVELS[-1]).plot(ax=panel)

if MPI.COMM_WORLD.rank == 0:
    figure.savefig("two_states.png", dpi=80)
    print(*comparison, sep="\n")
