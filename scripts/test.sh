#!/usr/bin/env bash
# Installs what is needed, builds everything optimised and with assertions, and runs every test.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/install-dependencies.sh
cmake --preset audit
cmake --build --preset audit --parallel "$(nproc)"
exec ctest --preset audit --parallel "$(nproc)"
