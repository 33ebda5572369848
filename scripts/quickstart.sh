#!/usr/bin/env bash
# From a bare Debian 12 to the first report: installs what is needed, builds the command, runs the damper example.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/install-dependencies.sh
cmake --preset release
cmake --build --preset release --target rubato_command --parallel "$(nproc)"
command=build/release/apps/rubato/rubato
"$command" run examples/underplatform-damper/study.toml -o results/underplatform-damper

echo
echo "The report is $PWD/results/underplatform-damper/report.html: open it in a browser."
echo "The command is $PWD/$command: try '$command example' for more studies."
