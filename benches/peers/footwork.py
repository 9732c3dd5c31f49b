"""footwork's own figures: its search as `footwork bench --json` wrote them, and a training.

python footwork.py DATABASE FOOTWORK [--bench FILE]
"""

import json
import subprocess
import tempfile
from pathlib import Path

import plane
import results

VARIANT = "indexed, "


def searches(bench):
    """Queries a second on all cores of the CPU, by the kind of queries."""
    rows = [row for row in json.loads(bench.read_text())["rows"] if row["device"] == "cpu"]
    cores = max(row["threads"] for row in rows)
    for row in rows:
        if row["threads"] == cores and row["variant"].startswith(VARIANT):
            yield row["variant"].removeprefix(VARIANT), row["per_s"]


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
    parser.add_argument("--bench", type=Path, help="figures of `footwork bench --filter search`")
    args = parser.parse_args()
    for name, speed in searches(args.bench) if args.bench else ():
        results.report(args.json, f"search, {name}", results.OURS, "queries/s", speed)
    whole = training(args, "--steps", f"{args.steps}")
    quick = training(args, "--stop-at-success", f"{plane.SUCCESS}")
    reached = quick["wall_s"] if quick["success"] >= plane.SUCCESS else None
    plane.report(args, results.OURS, whole["steps"] / whole["wall_s"], reached)


if __name__ == "__main__":
    main()
