#!/usr/bin/env bash
# Builds the wheel, installs it alone in a clean environment, and runs it outside the checkout.
set -euo pipefail
cd "$(dirname "$0")/.."
python=${PYTHON:-python3}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$python" -m build --quiet --wheel --outdir "$work/dist" .
"$python" -m venv "$work/env"
"$work/env/bin/python" -m pip install --quiet --disable-pip-version-check "$work"/dist/*.whl

cd "$work"
robokin=$work/env/bin/robokin
"$robokin" list --json > list.json
"$robokin" fk puma560 --q home
"$robokin" fk puma560 --q 90,0,90,0,0,0 --json > fk.json
"$work/env/bin/python" - <<'PY'
import json, pathlib, robokin
assert pathlib.Path(robokin.__file__).is_relative_to(pathlib.Path.cwd()), robokin.__file__
count = len(json.load(open("list.json")))
assert count >= 80, count
position = json.load(open("fk.json"))["pose"]["position"]
assert max(abs(a - b) for a, b in zip(position, [-149.09, 921.12, 20.32])) < 1e-9, position
print(f"the wheel is whole: {count} robots and mechanisms, the PUMA's home pose is right")
PY
