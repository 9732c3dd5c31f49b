"""Evaluates the ONNX files of a folder with ONNX Runtime, beside what is recorded of each: NAME.INPUT.f32 and
NAME.OUTPUT.f32, rows of 32-bit floats. Fails where an output is off by more than LARGEST."""

import sys
from pathlib import Path

import numpy as np
import onnxruntime

LARGEST = 1e-5


def check(path):
    session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])

    def recorded(port):
        values = np.fromfile(path.with_suffix(f".{port.name}.f32"), "<f4")
        return values.reshape(-1, *port.shape[1:])

    inputs = {port.name: recorded(port) for port in session.get_inputs()}
    found = session.run(None, inputs)
    worst = 0.0
    for port, output in zip(session.get_outputs(), found):
        wanted = recorded(port)
        assert output.shape == wanted.shape and np.ptp(wanted) > 0.1, (path.name, port.name)
        worst = max(worst, np.abs(output - wanted).max())
    rows = {len(values) for values in inputs.values()}
    print(f"{path.stem}: {rows} rows, off by {worst:.1e}")
    assert worst <= LARGEST, f"{path.name} is off by {worst}"


if __name__ == "__main__":
    for path in sorted(Path(sys.argv[1]).glob("*.onnx")):
        check(path)
