"""Results: on the screen, as JSON lines in a file, and a table of such a file.

python results.py FILE
"""

import json
import sys
from collections import defaultdict
from math import inf
from statistics import median

OURS = "footwork"


def add_option(parser):
    parser.add_argument("--json", metavar="FILE", help="append the results to this file")


def report(file, what, who, unit, value):
    """`value` is None for what was not reached."""
    print(f"{what}: {who}: {shown(value, unit)}", flush=True)
    if file:
        with open(file, "a") as lines:
            print(json.dumps({"what": what, "who": who, "unit": unit, "value": value}), file=lines)


def shown(value, unit):
    if value in (None, inf):
        return "not reached"
    return f"{value:,.{0 if value >= 100 else 1}f} {unit}"


def medians(results):
    """By what was measured and its unit, then by who."""
    values = defaultdict(lambda: defaultdict(list))
    for r in results:
        value = inf if r["value"] is None else r["value"]
        values[r["what"], r["unit"]][r["who"]].append(value)
    return {
        what: {who: median(found) for who, found in group.items()} for what, group in values.items()
    }


def table(results):
    """Markdown: medians, and how many times as good footwork is."""
    print("| what | who | result | footwork is better by |\n|---|---|---|---|")
    for (what, unit), group in medians(results).items():
        for who, value in group.items():
            by = "" if who == OURS or OURS not in group else ratio(unit, group[OURS], value)
            print(f"| {what} | {who} | {shown(value, unit)} | {by} |")


def ratio(unit, ours, theirs):
    if not (ours and theirs):
        return ""
    # Of seconds less is better.
    times = theirs / ours if unit == "s" else ours / theirs
    return f"{times:.1f} times" if times < inf else ""


if __name__ == "__main__":
    with open(sys.argv[1]) as lines:
        table([json.loads(line) for line in lines])
