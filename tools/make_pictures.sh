#!/usr/bin/env bash
# Makes every picture of the documentation anew with the command of the release build.
#
#   tools/make_pictures.sh [EXAMPLE ...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

cmake --preset release
cmake --build --preset release --target rubato_command --parallel "$(nproc)"
exec python3 tools/make_pictures.py build/release/apps/rubato/rubato "$@"
