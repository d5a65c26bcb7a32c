# Sourced by scripts/demo and scripts/test: installs the packages that are missing. Says in one line
# what it does; does nothing, quickly, when all is there.
# shellcheck shell=bash

build_packages=(
  g++ cmake ninja-build pkg-config
  ocl-icd-opencl-dev ocl-icd-libopencl1 opencl-headers opencl-clhpp-headers pocl-opencl-icd
  libopencv-dev libeigen3-dev libsuitesparse-dev libceres-dev libboost-dev
  libyaml-cpp-dev nlohmann-json3-dev libcli11-dev libfmt-dev
  libgtest-dev libgmock-dev libbenchmark-dev llvm-15-dev
)
test_packages=(clang-15 oclgrind clinfo clpeak python3-pyopencl python3-numpy)

# install_packages NAME…: what is missing of them.
install_packages() {
  local package missing=()
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' ||
      missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0

  local run_as=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null || ! sudo -n true 2>/dev/null && [ ! -t 0 ]; then
      echo "these packages are missing, and installing them needs root or sudo:" >&2
      echo "  ${missing[*]}" >&2
      return 1
    fi
    run_as=(sudo)
  fi
  echo "Installing ${#missing[@]} packages: ${missing[*]}"
  local log
  log=$(mktemp)
  if ! { "${run_as[@]}" apt-get update -q &&
         DEBIAN_FRONTEND=noninteractive "${run_as[@]}" apt-get install -y -q \
           --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
    echo "apt-get failed; its last lines (all of them: $log):" >&2
    tail -n 5 "$log" >&2
    return 1
  fi
  rm -f "$log"
}

# build_preset NAME [TARGET…]: configures quietly, builds with a short report.
build_preset() {
  local preset=$1 log
  shift
  log=$(mktemp)
  if ! cmake --preset "$preset" >"$log" 2>&1; then
    echo "cmake --preset $preset failed:" >&2
    tail -n 20 "$log" >&2
    return 1
  fi
  rm -f "$log"
  cmake --build --preset "$preset" ${1:+--target "$@"}
}
