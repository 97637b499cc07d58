# What ./quickstart and ./check share: the packages of the system, the build. Sourced by both, not run by itself.

# The one list of what the project needs from Debian. Building needs the first, running tests and micro-benchmarks the
# second as well.
build_packages=(clang-14 g++ cmake ninja-build libcli11-dev libfmt-dev libtomlplusplus-dev nlohmann-json3-dev libhdf5-dev
                librandom123-dev doctest-dev librapidcheck-dev)
test_packages=(clang-format-14 libclang-rt-14-dev libbenchmark-dev chromium fonts-dejavu-core python3 python3-numpy
               python3-h5py python3-matplotlib faketime slurmctld slurmd slurm-client munge parallel)

say() { printf '\n== %s\n' "$*"; }
fail() { printf 'error: %s\n' "$*" >&2; exit 1; }

# Installs those of the named packages that are missing; touches nothing when all are there.
install_packages() {
  command -v apt-get >/dev/null && command -v dpkg-query >/dev/null ||
    fail "this script installs with apt, which this system does not have: it is written for Debian 12 and its
relatives. Elsewhere install the equivalents of
  $*
and build by hand: cmake --preset release && cmake --build --preset release --target sandglass"

  local missing=() package
  for package in "$@"; do
    [[ $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) == installed ]] || missing+=("$package")
  done
  ((${#missing[@]})) || return 0

  local root=()
  if ((EUID != 0)); then
    command -v sudo >/dev/null ||
      fail "these packages are missing, and installing them needs root, but you are not root and there is no sudo.
Run as root: apt-get install --no-install-recommends ${missing[*]}
and then this script again; it needs no root once they are there."
    root=(sudo)
  fi

  say "Installing ${missing[*]}"
  local apt=("${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=120)
  # A stale list of another source is no reason to stop: whether the lists do is seen when installing from them.
  "${apt[@]}" update || printf 'warning: apt-get update failed; going on with the package lists of before\n' >&2
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}" ||
    fail "apt-get could not install ${missing[*]} (its reason stands above). If it could not reach its
servers, connect this machine to the network (or set apt's proxy) and run this script again."
}

# Cores to compile with: all, but no more than memory holds at 1.5 GB for each compiler.
build_jobs() {
  local cores memory_kb jobs
  cores=$(nproc)
  memory_kb=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo)
  jobs=$((memory_kb / 1500000))
  echo $((jobs < 1 ? 1 : jobs < cores ? jobs : cores))
}

# build PRESET [TARGET...]: configures and builds, re-using what is there.
build() {
  local preset=$1
  shift
  say "Building ($preset)"
  cmake --preset "$preset" -Wno-dev --log-level=WARNING
  cmake --build --preset "$preset" --parallel "$(build_jobs)" ${1:+--target "$@"}
}
