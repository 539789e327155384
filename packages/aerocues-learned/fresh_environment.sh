#!/usr/bin/env bash
# Both wheels in an environment of their own, without torch; then the command line, without network.
#
#     fresh_environment.sh [PYTHON]
#
# Only the installation needs an index of packages. The environment is removed in the end.
set -euo pipefail
cd "$(dirname "$0")/../.."
place=$(mktemp --directory)
trap 'rm -rf "$place"' EXIT
unset PYTHONPATH
export AEROCUES_CACHE="$place/cache"

"${1:-python3}" -m venv "$place/venv"
pip="$place/venv/bin/python -m pip --quiet --disable-pip-version-check"
$pip wheel --no-deps --wheel-dir "$place" . packages/aerocues-learned
$pip install --no-compile "$place"/*.whl

golden="$PWD/packages/aerocues-learned/tests/golden.npz"
"$place/venv/bin/python" - "$golden" "$place/photos" <<'PYTHON'
import importlib.util
import sys
from pathlib import Path

import cv2
import numpy as np

assert importlib.util.find_spec("torch") is None, "torch was installed"
source, target = sys.argv[1], Path(sys.argv[2])
target.mkdir()
with np.load(source) as file:
    for number in (1, 2):
        cv2.imwrite(str(target / f"{number}.png"), file[f"image_{number}"].astype(np.uint8))
PYTHON

offline=()
if unshare --map-root-user --net true 2> /dev/null; then
    offline=(unshare --map-root-user --net)
else
    echo "the network cannot be taken away here: the command line could use it" >&2
fi
cd "$place"
chosen="XFEAT-XFEAT-L2-EXACT,XFEAT-XFEAT-L2-LIGHTERGLUE,ALIKED_*-ALIKED_*-L2-EXACT,SIFT-SIFT-L2-EXACT,+learned"
printed=$("${offline[@]}" venv/bin/aerocues run photos -o results --timing shared --max-keypoints 500 --combinations "$chosen")
echo "$printed"
grep --quiet "rows     5: ok 5" <<< "$printed"
echo "both wheels work without torch${offline:+ and without network}"
