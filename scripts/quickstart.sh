#!/usr/bin/env bash
# From a bare Debian 12 to the first report: installs what is needed, builds the command and the Python package, runs the
# damper example.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/install-dependencies.sh
cmake --preset release
cmake --build --preset release --target rubato_command rubato_python --parallel "$(nproc)"
command=build/release/apps/rubato/rubato
"$command" run examples/underplatform-damper/study.toml -o results/underplatform-damper

echo
echo "The report is $PWD/results/underplatform-damper/report.html: open it in a browser."
echo "The command is $PWD/$command. To call it by its name:"
echo "  export PATH=$PWD/$(dirname "$command"):\$PATH"
echo "For Python, /usr/bin/python3 -c 'import rubato':"
echo "  export PYTHONPATH=$PWD/build/release/python"
echo "'rubato example' lists more studies, and docs/tutorial/README.md is the tutorial."
