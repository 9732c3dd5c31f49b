"""Writes every field of a database, as the reader in Python has it, into a file of its name."""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "examples/readers"))
from footwork_database import load  # noqa: E402

database, out = load(sys.argv[1]), Path(sys.argv[2])
arrays = "parents offsets mean scale features path hips rotations candidates motion"
for name in arrays.split():
    out.joinpath(name).write_bytes(getattr(database, name).tobytes())
out.joinpath("world").write_bytes(database.world(7)[0].astype("<f4").tobytes())
texts = "names roles clips fingerprint"
text = json.dumps({name: getattr(database, name) for name in texts.split()})
out.joinpath("header.json").write_text(text)
