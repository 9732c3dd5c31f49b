"""Where golden files go: beside the scripts, or where FOOTWORK_GOLDEN says."""

import os
from pathlib import Path

FOLDER = Path(os.environ.get("FOOTWORK_GOLDEN", Path(__file__).parent))
