# %% [markdown]
# # A damage law of your own
#
# The source lets damage grow with the third power of the stress. What would another power do?
# `power_law.py`, beside this script, is a law with any power m, in a file of its own: nothing of
# the program is edited. Before a number of it is believed it has to show what it claims, and it
# can: at m = 3 it must give the shipped law's crack, and without a threshold da/dN must go with
# Delta-K^m, on the very same path.
#
# | parameter | value |
# |---|---|
# | state | severe A-T, mesh 0, without a threshold |
# | Delta-K | 12 and 24 MPa sqrt(m) |
# | m | 3, 3.5, 4 |
# | extension | 20 um |
# | all else | as in the quickstart |
#
# `python docs/examples/own_law.py` writes `own_law.png`; `pearlite run SCENE.toml --load
# docs/examples/power_law.py` uses the law in a run.

# %%
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from mpi4py import MPI

import pearlite_petsc as pp

LAW = Path(__file__).with_name("power_law.py")
LEVELS = (12.0, 24.0)
shipped = pp.Scene(
    "own_law",
    load=LAW,
    states={"severe_AT": {"delta_k_th_mpa_sqrt_m": 0.0}},
    loading={"extension_um": 20.0},
)
mesh = pp.build_mesh(shipped, "severe_AT")


# %% [markdown]
# The law's parameters are keys of `[damage]`, with units, defaults and limits like all others. The
# mesh does not depend on them, so that all cracks start from one.


# %%
def grow(damage: dict[str, object]) -> list[pp.Crack]:
    scene = shipped.replace(damage=damage)
    return [pp.grow_crack(mesh, delta_k_mpa_sqrt_m=level, scene=scene) for level in LEVELS]


cubic = grow({"law": "objective"})
own = {m: grow({"law": "power_law", "exponent": m}) for m in (3.0, 3.5, 4.0)}

# %% [markdown]
# Two claims, tested: m = 3 is the shipped law, and twice the Delta-K is 2^m times the rate.

# %%
for ours, theirs in zip(own[3.0], cubic, strict=True):
    assert np.isclose(ours.da_dn_m_per_cycle, theirs.da_dn_m_per_cycle, rtol=1e-6)
slopes = {}
for m, (low, high) in own.items():
    assert np.array_equal(low.path.x_um, high.path.x_um)
    slopes[m] = np.log2(high.da_dn_m_per_cycle / low.da_dn_m_per_cycle)
    assert np.isclose(slopes[m], m, atol=1e-4)

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.8), layout="constrained")
own[4.0][1].plot(ax=left)
for m, cracks in own.items():
    rates = [crack.da_dn_m_per_cycle for crack in cracks]
    right.loglog(LEVELS, rates, "o-", label=f"m = {m:g}")
right.set_xticks(LEVELS, [f"{level:g}" for level in LEVELS])
right.tick_params(axis="x", which="minor", bottom=False, labelbottom=False)
right.set(xlabel=r"$\Delta K$ [MPa$\sqrt{\mathrm{m}}$]", ylabel="da/dN [m/cycle]")
right.grid(True, color="#e6e6e6")
right.legend()

if MPI.COMM_WORLD.rank == 0:
    figure.savefig("own_law.png", dpi=80)
    for m, slope in slopes.items():
        print(f"m = {m:g}: da/dN goes with Delta-K^{slope:.3f}")
