"""Options, processor time and output of the scripts: one JSON object a line for each quantity."""

import argparse
import importlib.metadata
import json
import time


def run(program, package, quantities, solve, warm_up=None):
    """Prints the values of `solve(edges)` and its processor time, without imports and `warm_up()`."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--edges", type=int, required=True, help="number of edges of each rod")
    edges = parser.parse_args().edges
    if warm_up is not None:
        warm_up()
    begin = time.process_time()
    values = solve(edges)
    seconds = time.process_time() - begin
    version = importlib.metadata.version(package)
    for quantity, value in zip(quantities, values, strict=True):
        row = {"program": program, "version": version, "quantity": quantity, "edges": edges}
        print(json.dumps(row | {"value": float(value), "time": seconds}))
