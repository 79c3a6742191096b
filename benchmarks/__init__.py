"""Speed and promises, as ratios and counts measured in one run: `make bench`, `make completeness`, `make coverage`.

Whatever is imported from here runs on one core, since a ratio should compare programs and not thread pools: numpy reads
that when it is imported, which is after this. The arms and the judges are those of the tests.
"""

import os
import sys
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
