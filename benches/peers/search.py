"""Exact nearest neighbours by Faiss, SciPy, ann-search and pynear, in queries a second, on all cores.

python search.py DATABASE [QUERIES ...]

QUERIES are files of raw little-endian f32 rows [n][28]: 27 numbers of a query and a 1. Without
them queries are drawn by the recipe of `src/bench/search.rs`.
"""

import argparse
import os
from pathlib import Path
from time import perf_counter

import ann_search
import faiss
import numpy as np
import pynear
from scipy.spatial import cKDTree

import results
from database import FEATURE, PADDED, POSE, load

COUNT, REPEATS = 8192, 3
# Standard deviation of the noise on the requested future.
NOISES = {"calm": 0.1, "noisy": 1.0, "wild": 2.6}


# From so many queries on Faiss multiplies matrices. In its default a batch of ours is too small for
# that; products are several times as quick here.
AS_IT_COMES = faiss.cvar.distance_compute_blas_threshold
PRODUCTS = 20


class Flat:
    """Exact search by Faiss on all cores, by matrix products from `threshold` queries on."""

    def __init__(self, rows, threshold):
        faiss.omp_set_num_threads(os.cpu_count())
        self.threshold = threshold
        self.index = faiss.IndexFlatL2(FEATURE)
        self.index.add(rows)

    def __call__(self, queries):
        """Indices of the nearest rows."""
        faiss.cvar.distance_compute_blas_threshold = self.threshold
        return self.index.search(queries, 1)[1][:, 0]


def drawn(rows, noise):
    """The pose of one row, the future of another, and noise on the future."""
    random = np.random.default_rng(1)
    queries, futures = (rows[random.integers(len(rows), size=COUNT)] for _ in range(2))
    scatter = random.standard_normal((COUNT, FEATURE - POSE), dtype=np.float32)
    queries[:, POSE:] = futures[:, POSE:] + noise * scatter
    return queries


def stored(path):
    return np.ascontiguousarray(np.fromfile(path, "<f4").reshape(-1, PADDED)[:, :FEATURE])


def best(search, queries):
    """The result of a search, and its queries a second in the best of several runs."""
    seconds = []
    for _ in range(REPEATS):
        begin = perf_counter()
        nearest = search(queries)
        seconds.append(perf_counter() - begin)
    return nearest, len(queries) / min(seconds)


def check(rows, queries, found):
    """All results are rows of the same distance, but for rounding."""
    distances = [np.linalg.norm(rows[nearest] - queries, axis=1) for nearest in found]
    for distance in distances[1:]:
        np.testing.assert_allclose(distance, distances[0], rtol=1e-3, atol=1e-3)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("database")
    parser.add_argument("queries", nargs="*", type=Path)
    results.add_option(parser)
    args = parser.parse_args()

    rows = load(args.database).rows
    tree = cKDTree(rows)
    kmknn = ann_search.KmknnIndex(n_neighbors=1).fit(rows)
    vp_tree = pynear.VPTreeL2Index()
    vp_tree.set(rows)
    searches = {
        "Faiss IndexFlatL2, as it comes": Flat(rows, AS_IT_COMES),
        "Faiss IndexFlatL2, matrix products": Flat(rows, PRODUCTS),
        "SciPy cKDTree": lambda queries: tree.query(queries, workers=-1)[1],
        "ann-search KMKNN": lambda queries: kmknn.kneighbors(queries)[1][:, 0],
        "pynear VPTreeL2": lambda queries: np.array(vp_tree.search1NN(queries)[0]),
    }
    files = {path.stem: stored(path) for path in args.queries}
    for name, queries in (files or {name: drawn(rows, n) for name, n in NOISES.items()}).items():
        found = []
        for who, search in searches.items():
            nearest, speed = best(search, queries)
            found.append(nearest)
            results.report(args.json, f"search, {name}", who, "queries/s", speed)
        check(rows, queries, found)


if __name__ == "__main__":
    main()
