#!/bin/sh
# Sets up, runs and checks pearlite_petsc on Debian and Ubuntu; "./pearlite.sh help" says how.
set -eu

root=$(dirname -- "$(readlink -f -- "$0")")
venv=$root/.venv
python=${PEARLITE_PYTHON:-/usr/bin/python3}

# Everything that is compiled against PETSc, MPI or numpy comes from the distribution as one
# set; what pip adds must not replace any of it.
packages="python3 python3-venv python3-numpy python3-scipy python3-h5py python3-mpi4py
python3-petsc4py python3-petsc4py-real openmpi-bin python3-matplotlib"
# Taken from the distribution only where it has shapely 2 (Debian 13); from PyPI otherwise.
modern_packages="python3-shapely python3-meshio"
# The same by their Python names. h5py of Debian 12 cannot be found by its Python name, so these
# are not even asked of pip.
packaged="numpy scipy h5py mpi4py petsc4py matplotlib"

usage() {
    cat <<'END'
Usage: ./pearlite.sh COMMAND [ARGS]

  run [ARGS]     pearlite run --ranks RANKS ARGS; "run --help" lists them
  test [ARGS]    ruff, mypy --strict, a two-rank run, pytest on all cores with ARGS
                 (--slow for the long ones, -n 0 for --pdb)
  exec CMD...    run CMD in the environment
  setup [test]   set up only; "test" adds the tools of the checks
  help           this text

Each command first sets up what is missing (Debian 12 and 13; untested on Ubuntu 24.04): packages of
the distribution, for which it needs root or sudo, and a virtual environment in .venv.

Environment variables:
  PEARLITE_RANKS         number of MPI ranks of "run"; default: the cores of this machine
  PETSC_DIR, PETSC_ARCH  use your own PETSc and MPI; nothing of the distribution is installed
  PEARLITE_PYTHON        Python to build on; default /usr/bin/python3
END
}

fail() {
    printf 'pearlite.sh: %s\n' "$1" >&2
    exit "${2:-1}"
}

# A stop ends with one line; the next call repairs what it interrupted.
on_stop() {
    trap '' INT TERM
    [ -z "$child" ] || kill "$child" 2>/dev/null || true
    fail "stopped; the next call repeats what was not finished" 130
}

# Runs a command that would answer Ctrl-C with a traceback: in the background it does not get it.
quietly_stopped() {
    "$@" &
    child=$!
    code=0
    wait "$child" || code=$?
    child=
    return "$code"
}

say() {
    printf 'pearlite.sh: %s\n' "$*" >&2
}

distribution_petsc() {
    for folder in /usr/lib/petscdir/petsc[0-9]*/*-real; do
        if [ -d "$folder/lib/python3/dist-packages/petsc4py" ]; then
            printf '%s\n' "$folder"
        fi
    done | sort -V | tail -n 1
}

# own_petsc is empty where PETSc is the distribution's.
find_petsc() {
    own_petsc=
    case ${PETSC_DIR:-} in
        '') PETSC_DIR=$(distribution_petsc) ;;
        /usr/lib/petsc*) ;;
        *)
            [ -d "$PETSC_DIR" ] || fail "PETSC_DIR: $PETSC_DIR is not a folder" 2
            own_petsc=$PETSC_DIR/${PETSC_ARCH:-}
            ;;
    esac
    [ -z "$PETSC_DIR" ] || export PETSC_DIR
}

set_environment() {
    export VIRTUAL_ENV="$venv" PYTHONNOUSERSITE=1
    if [ -n "$own_petsc" ]; then
        PATH=$venv/bin:$own_petsc/bin:$PATH
        if [ -d "$own_petsc/lib/petsc4py" ]; then
            PYTHONPATH=$own_petsc/lib${PYTHONPATH:+:$PYTHONPATH}
        fi
    else
        PATH=$venv/bin:$PATH
    fi
    export PATH PYTHONPATH="$root${PYTHONPATH:+:$PYTHONPATH}"
    export LC_ALL=C.UTF-8 MPLBACKEND=Agg HOME="${HOME:-/}"
    if [ ! -w "$HOME" ]; then
        export MPLCONFIGDIR="${MPLCONFIGDIR:-${TMPDIR:-/tmp}/pearlite-matplotlib-$(id -u)}"
    fi
    # One thread a rank: the ranks are the parallelism.
    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    # Names for Open MPI 4 (OMPI, orte) and 5 (PRTE); what the user has set stays.
    if [ "$(id -u)" -eq 0 ]; then
        export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
        export PRTE_ALLOW_RUN_AS_ROOT=1 PRTE_ALLOW_RUN_AS_ROOT_CONFIRM=1
    fi
    # Copies between processes are forbidden in most containers.
    export OMPI_MCA_btl_vader_single_copy_mechanism="${OMPI_MCA_btl_vader_single_copy_mechanism:-none}"
    # More ranks than cores, and two jobs at once, must neither be refused nor share a core.
    export OMPI_MCA_rmaps_base_oversubscribe="${OMPI_MCA_rmaps_base_oversubscribe:-1}"
    export OMPI_MCA_hwloc_base_binding_policy="${OMPI_MCA_hwloc_base_binding_policy:-none}"
    export PRTE_MCA_rmaps_default_mapping_policy="${PRTE_MCA_rmaps_default_mapping_policy:-:oversubscribe}"
    export PRTE_MCA_hwloc_default_binding_policy="${PRTE_MCA_hwloc_default_binding_policy:-none}"
    # A container's network only brings warnings. Not btl=^tcp: without any network layer, Open MPI
    # 4.1 crashes in one-sided calls, by which the ranks share out the tasks.
    if [ -z "${SLURM_JOB_ID:-}${PBS_JOBID:-}${LSB_JOBID:-}" ]; then
        export OMPI_MCA_btl_tcp_if_include="${OMPI_MCA_btl_tcp_if_include:-lo}"
    fi
}

# What the environment was made from; another value means that it has to be made again.
fingerprint() {
    {
        cat "$root/pyproject.toml" "$root/pearlite.sh"
        grep -E '^(ID|VERSION_ID|VERSION_CODENAME)=' /etc/os-release || true
        readlink -f -- "$python" || true
        printf '%s\n' "$own_petsc" "$root"
    } 2>/dev/null | sha256sum
}

is_set_up() {
    [ -n "${PETSC_DIR:-}" ] && [ -f "$venv/set-up-for-$1" ] &&
        [ "$(cat "$venv/set-up-for-$1")" = "$(fingerprint)" ]
}

is_installed() {
    dpkg-query -W -f '${db:Status-Status}\n' "$1" 2>/dev/null | grep -qx installed
}

missing_packages() {
    for package in "$@"; do
        is_installed "$package" || printf '%s ' "$package"
    done
}

# Fails where sudo would ask for a password that nobody can type.
check_sudo() {
    [ "$(id -u)" -ne 0 ] || return 0
    command -v sudo >/dev/null || fail "needs root or sudo to install: $1"
    if ! sudo -n true 2>/dev/null && ! (: </dev/tty) 2>/dev/null; then
        fail "sudo wants a password and there is no terminal to type it; call 'sudo -v' before, or as root: apt-get install --no-install-recommends $1"
    fi
}

as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        env DEBIAN_FRONTEND=noninteractive "$@"
    else
        sudo env DEBIAN_FRONTEND=noninteractive "$@"
    fi
}

candidate() {
    apt-cache policy "$1" | sed -n 's/^  Candidate: \([0-9].*\)/\1/p'
}

# What apt-get says of the size before it asks whether to go on; the answer here is no.
say_size() {
    { as_root env LC_ALL=C apt-get --no-install-recommends --assume-no install "$@" 2>/dev/null ||
        true; } | grep -E '^(Need to get|After this operation)' |
        while read -r line; do say "$line"; done || true
}

install_packages() {
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        fail "this is neither Debian nor Ubuntu: install what corresponds to $(echo "$packages" | paste -s -d ' '), or build PETSc with petsc4py, set PETSC_DIR (and PETSC_ARCH), and call again or use 'pip install .'"
    fi
    # shellcheck disable=SC2086 # lists of words
    missing=$(missing_packages $packages)
    if [ -n "$missing" ]; then
        check_sudo "${missing% }"
        say "installing $(echo "$missing" | wc -w) packages of the distribution and their dependencies"
        # Left behind by an apt-get that was interrupted.
        if [ -n "$(as_root dpkg --audit)" ]; then
            as_root dpkg --configure -a >&2 || fail "dpkg --configure -a failed: see above"
        fi
        as_root apt-get -q -q update || fail "apt-get update failed"
        if dpkg --compare-versions "$(candidate python3-shapely)" ge 2; then
            missing="$missing $modern_packages"
        fi
        # shellcheck disable=SC2086
        say_size $missing
        # shellcheck disable=SC2086
        as_root apt-get -q -q -y --no-install-recommends -o DPkg::Lock::Timeout=300 \
            -o Dpkg::Use-Pty=0 install $missing >&2 || fail "apt-get could not install: $missing"
        # Where sudo runs it in a terminal of its own, Ctrl-C reaches apt-get alone, which ends with 0.
        # shellcheck disable=SC2086
        missing=$(missing_packages $packages)
        [ -z "$missing" ] || fail "apt-get was stopped before it had installed ${missing% }; call again"
        find_petsc
    fi
    [ -n "${PETSC_DIR:-}" ] ||
        fail "no PETSc with petsc4py below /usr/lib/petscdir: reinstall python3-petsc4py-real"
}

# requirements LEFT_OUT LIST...: what pyproject.toml names, one a line; "run" are the dependencies.
requirements() {
    "$python" -I - "$root/pyproject.toml" "$@" <<'END'
import re, sys, tomllib
with open(sys.argv[1], "rb") as file:
    project = tomllib.load(file)["project"]
lists = {"run": project["dependencies"], **project["optional-dependencies"]}
for line in sum([lists[name] for name in sys.argv[3:]], []):
    if re.match(r"[\w.-]+", line)[0] not in sys.argv[2].split():
        print(line)
END
}

# "name==version" of what the distribution has, or of the user's PETSc.
constraints() {
    if [ -n "$own_petsc" ]; then
        version=$(sed -n 's/^#define PETSC_VERSION_\(MAJOR\|MINOR\) *\([0-9]*\).*/\2/p' \
            "$PETSC_DIR/include/petscversion.h" | paste -s -d .)
        echo "petsc4py==$version.*"
        # Older petsc4py knows numpy 1 alone.
        case $version in 3.1? | 3.2[01]) echo "numpy<2" ;; esac
        return
    fi
    # shellcheck disable=SC2086
    "$python" -I - "$PETSC_DIR/lib/python3/dist-packages" $packaged shapely meshio <<'END'
import importlib.metadata, sys
folders = ["/usr/lib/python3/dist-packages", sys.argv[1]]
for name in sys.argv[2:]:
    for found in importlib.metadata.distributions(name=name, path=folders):
        print(f"{name}=={found.version}")
        break
END
}

# pip_install ENVIRONMENT LEFT_OUT LIST...
pip_install() {
    into=$1
    shift
    requirements "$@" >"$into/requirements.txt"
    # As a variable the constraints hold for what packages are built with, too; without a folder,
    # because pip would split its name at spaces.
    quietly_stopped env -C "$into" PIP_CONSTRAINT=constraints.txt PYTHONPATH='' bin/python -m pip \
        install --quiet --no-input --disable-pip-version-check --prefer-binary \
        -r requirements.txt >&2 || fail "pip could not install the packages named in pyproject.toml"
}

# make_venv FOLDER [OPTIONS]
make_venv() {
    folder=$1
    shift
    quietly_stopped "$python" -m venv --clear "$@" "$folder" || fail "could not make $folder"
}

# What makes the environment work by itself, after ". .venv/bin/activate": the program, the
# distribution's petsc4py, one thread a rank, and the command pearlite.
make_independent() {
    for site in "$venv"/lib/python3*/site-packages; do
        {
            echo "$root"
            [ -n "$own_petsc" ] || echo "$PETSC_DIR/lib/python3/dist-packages"
            echo "import os; [os.environ.setdefault(f'{n}_NUM_THREADS', '1') for n in ('OMP', 'OPENBLAS')]"
        } >"$site/pearlite.pth"
    done
    # shellcheck disable=SC2016
    printf '#!/bin/sh\nexec "$(dirname -- "$(readlink -f -- "$0")")/python" -m pearlite_petsc "$@"\n' \
        >"$venv/bin/pearlite"
    chmod +x "$venv/bin/pearlite"
}

make_environment() {
    "$python" -I -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
        fail "$python is not Python 3.11 or newer"
    # An environment whose making was interrupted cannot be trusted: begin again.
    if [ "$(cat "$venv/made-from" 2>/dev/null)" != "$(fingerprint)" ] || [ -e "$venv/unfinished" ]; then
        say "making the virtual environment .venv"
        if [ -n "$own_petsc" ]; then
            make_venv "$venv"
        else
            make_venv "$venv" --system-site-packages
        fi
    fi
    : >"$venv/unfinished"
    left_out=$packaged
    if [ -n "$own_petsc" ]; then
        # Ready-made ones would bring the wrong MPI.
        export PIP_NO_BINARY=mpi4py,petsc4py
        left_out=
        # PETSc may have been built with its petsc4py.
        ! python -c 'import petsc4py' 2>/dev/null || left_out=petsc4py
    fi
    constraints >"$venv/constraints.txt"
    say "installing the Python packages that the distribution lacks"
    if [ "$1" = test ]; then
        pip_install "$venv" "$left_out" run petsc dev bench
        # Types of numpy differ from version to version: the type checker sees the same one
        # everywhere, in an environment of its own.
        make_venv "$venv/types"
        : >"$venv/types/constraints.txt"
        pip_install "$venv/types" '' types
        ln -sf "$venv/types/bin/mypy" "$venv/bin/mypy"
    else
        pip_install "$venv" "$left_out" run petsc
    fi
    if [ -z "$own_petsc" ]; then
        # MPICH's mpirun, if it is the system's first, cannot start the distribution's petsc4py.
        ln -sf "$(command -v /usr/bin/mpirun.openmpi || echo /usr/bin/mpirun)" "$venv/bin/mpirun"
    fi
    make_independent
    python -c '
import h5py, matplotlib, meshio, mpi4py, numpy, scipy, shapely
from petsc4py import PETSc
assert PETSc.ScalarType is numpy.float64, "PETSc is built for complex numbers"' ||
        fail "the environment cannot be used: see the error above"
    fingerprint >"$venv/made-from"
    fingerprint >"$venv/set-up-for-$1"
    rm -f "$venv/unfinished"
}

# Sets up for "run" or "test", once; two calls at the same time wait for each other.
set_up() {
    if is_set_up "$1" || { [ "$1" = run ] && is_set_up test; }; then
        return
    fi
    what="setup"
    [ "$1" = run ] || what="setup $1"
    [ -w "$root" ] || fail "$root is not writable and not set up for '$1': call ./pearlite.sh $what as its owner"
    child=
    trap on_stop INT TERM
    exec 9<"$root"
    flock 9
    if ! is_set_up "$1"; then
        [ -n "$own_petsc" ] || install_packages
        make_environment "$1"
    fi
    exec 9<&-
    trap - INT TERM
}

# What needs no environment is answered before one is made: --help, --version, a wrong option.
check_options() {
    wanted=check
    for word; do
        case $word in
            --) break ;;
            -h | --help | --version) wanted=answer ;;
        esac
    done
    [ "$wanted" = answer ] || ! is_set_up run || return 0
    for found in "$venv/bin/python" "$python"; do
        if "$found" -I -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            PYTHONPATH=$root "$found" -B -m pearlite_petsc.run_options "$@" || exit
            [ "$wanted" = check ] || exit 0
            return 0
        fi
    done
    [ "$wanted" = check ] ||
        fail "Python is not installed yet: ./pearlite.sh setup installs it; docs/reference.md lists the options"
}

cores() {
    # nproc would answer with OMP_NUM_THREADS.
    count=$(env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc)
    # It does not see a container's share of processor time.
    if read -r quota period 2>/dev/null </sys/fs/cgroup/cpu.max && [ "$quota" != max ]; then
        share=$(((quota + period - 1) / period))
        [ "$share" -ge "$count" ] || count=$share
    fi
    echo "$count"
}

ranks() {
    if [ -n "${PEARLITE_RANKS:-}" ]; then
        case $PEARLITE_RANKS in
            *[!0-9]* | 0*) fail "PEARLITE_RANKS: $PEARLITE_RANKS is not a positive whole number" 2 ;;
        esac
        echo "$PEARLITE_RANKS"
        return
    fi
    cores
}

two_rank_run() {
    folder=$(mktemp -d)
    outcome=0
    mpirun -n 2 python -m pearlite_petsc.run "$root/runs/quickstart.toml" \
        --output "$folder/run" --set ensemble.meshes=1 \
        --set 'loading.delta_k_mpa_sqrt_m=[18]' >"$folder/log" 2>&1 || outcome=$?
    rows=$(sed 1d "$folder/run/fcg.csv" 2>/dev/null | wc -l)
    if [ "$outcome" -ne 0 ] || [ "$rows" -ne 5 ]; then
        cat "$folder/log"
        say "exit status $outcome and $rows rows in fcg.csv, not 0 and 5 (one a state)"
        outcome=1
    fi
    rm -rf "$folder"
    return "$outcome"
}

failed=
check() {
    say "$1"
    shift
    "$@" || failed="$failed, $*"
}

run_checks() {
    cd "$root"
    check "style" ruff check
    check "format" ruff format --check
    check "types" mypy --strict pearlite_petsc
    check "two ranks" two_rank_run
    # Of the whole suite alone: part of it covers part of the product.
    [ $# -gt 0 ] || set -- --cov --cov-report= --cov-fail-under=95
    # Last, so that its closing line is the last one of the output.
    check "tests" python -m pytest -n "$(cores)" --dist worksteal "$@"
    [ -z "$failed" ] || fail "failed: ${failed#, }"
}

command=${1:-help}
[ $# -eq 0 ] || shift
case $command in
    help | -h | --help) usage && exit ;;
    run) number=$(ranks) ;;
    test | exec) ;;
    setup) case ${1:-run} in run | test) ;; *) fail "setup $1: only 'test' may follow setup" 2 ;; esac ;;
    *) fail "$command is not a command: run, test, exec, setup or help" 2 ;;
esac
[ "$command" != exec ] || [ $# -gt 0 ] || fail "exec needs a command" 2

find_petsc
set_environment
case $command in
    run)
        check_options "$@"
        set_up run
        exec python -m pearlite_petsc.run --ranks "$number" "$@"
        ;;
    test)
        set_up test
        run_checks "$@"
        ;;
    exec)
        set_up run
        exec "$@"
        ;;
    setup) set_up "${1:-run}" ;;
esac
