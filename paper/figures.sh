#!/bin/sh
# Make the figure and the listing of paper.md, from the root of the repository: sh paper/figures.sh
set -eu
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
# a right solution of which the stop watches one wall instead of four
sed 's/min(pose.x, pose.y, 11.09 - pose.x, 11.09 - pose.y) < 0.9/pose.x > 10.2/' \
    tests/submissions/quick_spiral.py >"$made/turtle_controller.py"
grader run "$made/turtle_controller.py" --out "$made/graded" | sed -n 1,3p
chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir="$made/browser" \
    --window-size=1280,1200 --screenshot=paper/report.png "file://$made/graded/report.html" 2>"$made/log"
python - <<'PYTHON'
from PIL import Image

page = Image.open("paper/report.png").convert("RGB")
page.quantize(128).save("paper/report.png", optimize=True)
PYTHON
