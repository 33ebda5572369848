#!/usr/bin/env bash
# Installs what Rubato needs on Debian 12: its packages with apt and, with npm, the plotting library of the report.
#
#   scripts/install-dependencies.sh            what a build and the tests need
#   scripts/install-dependencies.sh --build    what a build needs, and nothing for the tests
#   scripts/install-dependencies.sh --tidy     also clang-tidy, which the slow tests run
#   scripts/install-dependencies.sh --bench    also the integrators that the benchmarks measure Rubato against
#
# Works as root and as a user with sudo. Asks no network for what is already there.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=(g++ cmake ninja-build python3 libeigen3-dev libfmt-dev libtomlplusplus-dev libnetcdf-dev
       libsuitesparse-dev libspectra-dev libcli11-dev libtbb-dev
       python3-dev pybind11-dev python3-numpy python3-xarray python3-matplotlib python3-venv python3-setuptools python3-wheel)
tests=(libgtest-dev libgmock-dev python3-jsonschema python3-netcdf4 python3-pytest python3-scipy clang-format chromium chromium-driver)
bench=(libbenchmark-dev libboost-dev libsundials-dev)

tidy=(clang-tidy)

packages=("${build[@]}" "${tests[@]}")
for argument in "$@"; do
  case $argument in
    --build) packages=("${build[@]}") ;;
    --tidy) packages=("${build[@]}" "${tests[@]}" "${tidy[@]}") ;;
    --bench) packages=("${build[@]}" "${tests[@]}" "${bench[@]}") ;;
    *) sed -n '2,9s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2; exit 2 ;;
  esac
done
# Other packagings of Node.js bring npm along and refuse Debian's beside it.
command -v npm >/dev/null || packages+=(nodejs npm)

missing=()
for package in "${packages[@]}"; do
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ]; then
  as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
      echo "Not root, and no sudo here. Ask an administrator for: apt-get install ${missing[*]}" >&2
      exit 1
    }
    as_root=(sudo)
  fi
  echo "Installing from Debian: ${missing[*]}"
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 \
    apt-get install -y -q --no-install-recommends -o Dpkg::Use-Pty=0 "${missing[@]}"
fi

# npm leaves its own lock file in node_modules in another form, so that ours is kept beside it to compare with.
if ! cmp -s package-lock.json node_modules/.installed-lock.json; then
  echo "Installing from the npm registry: the plotting library of the report, pinned by package-lock.json"
  npm ci --ignore-scripts --no-update-notifier
  cp package-lock.json node_modules/.installed-lock.json
fi
