#!/usr/bin/env bash
# scripts/experiments/README.md names each shipped experiment once, and nothing else: its table against the folder.
set -euo pipefail
cd "${1:?folder of the experiments}"
named=$(sed -n '/^###/q; s/^| \(`[^|]*\) |.*/\1/p' README.md | tr -d '`' | tr ' ' '\n' | sort)
there=$(for f in *.yaml; do echo "${f%.yaml}"; done | sort)
diff <(echo "$named") <(echo "$there") || { echo "README.md (<) and the files (>) differ" >&2; exit 1; }
