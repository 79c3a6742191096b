#!/usr/bin/env bash
# Builds the wheel and the list of what it stands on in dist/, installs it with the locked versions alone in a
# clean environment, and runs it outside the checkout. The environment that runs this has .ci/requirements/release.txt.
set -euo pipefail
cd "$(dirname "$0")/.."
python=$(realpath --no-symlinks "${PYTHON:-python3}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

build() { "$python" -m pip wheel --quiet --no-deps --no-build-isolation --wheel-dir "$1" .; }
rm -f dist/robokin-*
build dist
wheel=$(echo dist/robokin-*.whl)
# Where no compiler is found, or it fails, the wheel is the same but for the native kernel, and no word is said.
CC=$work/none build "$work/pure" 2>&1 | tee "$work/said"
test ! -s "$work/said"
pure=$(echo "$work"/pure/robokin-*-py3-none-any.whl)
if CC=$work/none ROBOKIN_REQUIRE_KERNEL=1 build "$work/required" 2> /dev/null; then echo "a kernel was required" >&2; exit 1; fi

# No pip in it: what is found there afterwards is the wheel and what it requires. The wheel is content with the lock.
"$python" -m venv --without-pip "$work/env"
install() { "$python" -m pip --python "$work/env/bin/python" --quiet --disable-pip-version-check install --no-compile "$@"; }
install --require-hashes -r .ci/requirements/user.txt
install --no-index "$wheel"

"$python" -m cyclonedx_py environment --pyproject pyproject.toml --output-reproducible --validate \
  --output-file "${wheel%.whl}.cdx.json" "$work/env/bin/python" 2> "$work/notes" || { cat "$work/notes" >&2; exit 1; }

sbom=$(realpath "${wheel%.whl}.cdx.json")
cd "$work"
robokin=$work/env/bin/robokin
"$robokin" --version
"$robokin" list --json > list.json
"$robokin" fk puma560 --q home
"$robokin" fk puma560 --q 90,0,90,0,0,0 --json > fk.json
"$work/env/bin/python" - "$sbom" <<'PY'
import json, pathlib, re, sys, robokin
from importlib.metadata import distributions
assert pathlib.Path(robokin.__file__).is_relative_to(pathlib.Path.cwd()), robokin.__file__
count = len(json.load(open("list.json")))
assert count >= 80, count
position = json.load(open("fk.json"))["pose"]["position"]
assert max(abs(a - b) for a, b in zip(position, [-149.09, 921.12, 20.32])) < 1e-9, position
sbom = json.load(open(sys.argv[1]))
plain = lambda name: re.sub("[-_.]+", "-", name).lower()
listed = {plain(part["name"]) for part in sbom["components"]} | {plain(sbom["metadata"]["component"]["name"])}
installed = {plain(d.metadata["Name"]) for d in distributions()}
assert sbom["bomFormat"] == "CycloneDX" and listed == installed, (listed, installed)
print(f"the wheel is whole: {count} robots and mechanisms, the PUMA's home pose is right; it stands on "
      f"{len(installed) - 1} packages, listed in dist/{pathlib.Path(sys.argv[1]).name}")
PY
install --no-index --no-deps --force-reinstall "$pure"
test "$("$robokin" --version)" = "$("$work/env/bin/python" -c 'import robokin; print("robokin", robokin.__version__)') (python kernel)"
"$robokin" fk puma560 --q 90,0,90,0,0,0 --json > pure.json
"$work/env/bin/python" - <<'PY'
import json
one, other = (json.load(open(name))["pose"]["position"] for name in ("fk.json", "pure.json"))
assert max(abs(a - b) for a, b in zip(one, other)) < 1e-9, (one, other)
print("without a compiler the wheel answers the same in Python")
PY
