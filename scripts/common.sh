# shellcheck shell=bash
# Shared by dev and its scripts; sourced, never run.
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"

note() { printf '\n== %s\n' "$*" >&2; }
die() {
  printf 'dev: %s\n' "$*" >&2
  exit 2
}

as_root() {
  if ((EUID == 0)); then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    die "packages are missing and there is neither root nor sudo. As root: $*"
  fi
}

# Compilers of Eigen code take about 1.5 GB each; a small machine must not swap.
jobs_allowed() {
  local cores memory_kb by_memory
  cores="$(nproc)"
  memory_kb="$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo)"
  by_memory=$((memory_kb / 1500000))
  if ((by_memory < 1)); then by_memory=1; fi
  echo $((by_memory < cores ? by_memory : cores))
}

# Where what can be made again is kept between clones.
cache_dir() { printf '%s/offnominal' "${XDG_CACHE_HOME:-$HOME/.cache}"; }

# Compilations are remembered (ccache), wherever the tree lies: another clone, or a branch that was
# left and taken up again, builds in a fraction of the time. Its settings are in the build's own commands:
# what a plain ninja compiles is remembered alike.
remember_compilations() {
  command -v ccache >/dev/null || return 0
  local launcher="env;CCACHE_BASEDIR=${CCACHE_BASEDIR:-$root};CCACHE_NOHASHDIR=${CCACHE_NOHASHDIR:-1};ccache"
  export CMAKE_CXX_COMPILER_LAUNCHER="${CMAKE_CXX_COMPILER_LAUNCHER:-$launcher}"
}

# build PRESET [TARGET...]: configures and builds; silent when nothing is to do. All output on stderr.
# Extra ninja options may come in NINJA_OPTIONS.
build() {
  local preset="$1" dir
  shift
  dir="$root/build/$preset"
  remember_compilations
  # What ninja does not know of; all else makes it configure anew by itself. From nothing: where a preset
  # has another compiler, CMake drops its cache with all that the preset had put there.
  if [[ ! -f "$dir/build.ninja" || "$root/CMakePresets.json" -nt "$dir/build.ninja" ||
    "$root/scripts/common.sh" -nt "$dir/build.ninja" ]]; then
    note "configure ($preset)"
    (cd "$root" && cmake --fresh --preset "$preset" --log-level=WARNING) >&2 || return 1
  fi
  # shellcheck disable=SC2086  # a list of options, split on purpose
  ninja -C "$dir" -j "$(jobs_allowed)" ${NINJA_OPTIONS:-} "$@" 2>&1 |
    sed -u '/^ninja: Entering directory/d; /Re-checking globbed directories/d; /^ninja: no work to do/d' >&2
}

# build_firmware: the Cortex-M firmware, both processors; needs the command, which writes its constants.
build_firmware() {
  build release offnominal && build cortex-m7 && build cortex-m4
}
