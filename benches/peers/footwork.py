"""footwork's own figures: its search as `cargo bench --bench search` left them, and a training.

python footwork.py DATABASE FOOTWORK
"""

import json
import os
import subprocess
import tempfile
from pathlib import Path

import plane
import results

BENCHES = "indexed, all cores, "


def searches():
    """Queries a second by name; none if the bench has not run."""
    found = Path(os.environ.get("CARGO_TARGET_DIR", "target"), "criterion", "search")
    for path in sorted(found.glob("*/new/benchmark.json")):
        bench = json.loads(path.read_text())
        if bench["function_id"].startswith(BENCHES):
            estimates = json.loads(path.with_name("estimates.json").read_text())
            name, count = (
                bench["function_id"].removeprefix(BENCHES),
                bench["throughput"]["Elements"],
            )
            yield name, count / estimates["median"]["point_estimate"] * 1e9


def training(args, *limits):
    """The summary of a training within limits."""
    with tempfile.TemporaryDirectory() as folder:
        command = [args.footwork, "train", "plane", "--device", "cpu", "--data", args.database]
        command += [*limits, "--max-time", f"{args.max_time:.0f}s"]
        subprocess.run([*command, "--seed", f"{args.seed}", "--out", folder], check=True)
        return json.loads(Path(folder, "summary.json").read_text())


def main():
    parser = plane.options(__doc__)
    parser.add_argument("footwork", help="the program")
    args = parser.parse_args()
    for name, speed in searches():
        results.report(args.json, f"search, {name}", results.OURS, "queries/s", speed)
    whole = training(args, "--steps", f"{args.steps}")
    quick = training(args, "--stop-success", f"{plane.SUCCESS}")
    reached = quick["wall_s"] if quick["success"] >= plane.SUCCESS else None
    plane.report(args, results.OURS, whole["steps"] / whole["wall_s"], reached)


if __name__ == "__main__":
    main()
