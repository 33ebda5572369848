#!/usr/bin/env bash
# Installs what is needed, builds everything optimised and with assertions, and runs the tests.
#
#   scripts/test.sh          all but those with the label `slow`
#   scripts/test.sh --all    those as well: thousands of random studies, clang-tidy, the how-to pages; hours
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

selection=(--label-exclude slow)
extras=()
case ${1:-} in
  "") ;;
  --all) selection=(); extras=(--tidy) ;;
  *) sed -n '2,6s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2; exit 2 ;;
esac

scripts/install-dependencies.sh "${extras[@]}"
cmake --preset audit
cmake --build --preset audit --parallel "$(nproc)"
exec ctest --preset audit --parallel "$(nproc)" "${selection[@]}"
