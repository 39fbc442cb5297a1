"""What the ranks of one script see of the face; started by mpirun, prints one line a rank."""

import sys

from mpi4py import MPI

import pearlite_petsc as pp
from tests.face.scenes import small_scene

world = MPI.COMM_WORLD
scene = small_scene()
mesh = pp.build_mesh(scene, "severe_AT")
shared = pp.grow_crack(mesh, delta_k_mpa_sqrt_m=18.0)
# Each rank for itself, another Delta-K each.
own = pp.grow_crack(mesh, delta_k_mpa_sqrt_m=18.0 + world.rank, comm=MPI.COMM_SELF)
with pp.Growth(mesh, delta_k_mpa_sqrt_m=18.0, comm=world) as growth:
    lengths = [step.crack_length_um for step in growth]
    crack = growth.crack()
results = pp.run(scene, sys.argv[1])
refused = ""
try:
    pp.grow_crack(mesh, delta_k_mpa_sqrt_m=18.0, scene=scene.replace(states=["undeformed"]))
except pp.PearliteError as error:
    refused = str(error)
sys.stdout.write(
    f"rank {world.rank} {shared.da_dn_m_per_cycle!r} {crack.da_dn_m_per_cycle!r} {lengths[-1]!r} "
    f"{own.delta_k_mpa_sqrt_m:g} {own.da_dn_m_per_cycle!r} {len(results)} {bool(refused)}\n"
)
sys.stdout.flush()
