"""Evaluates the safetensors files of a folder with NumPy, by their metadata alone, beside the actions that are recorded
of each: NAME.INPUT.f32 and NAME.action.f32. Fails where one is off by more than LARGEST."""

import json
import sys
from pathlib import Path

import numpy as np

LARGEST = 1e-5
ACTIVATIONS = {"relu": lambda x: np.maximum(x, 0), "tanh": np.tanh, "identity": lambda x: x}


def load(path):
    """Tensors by name, and the metadata."""
    data = path.read_bytes()
    length = int.from_bytes(data[:8], "little")
    header = json.loads(data[8 : 8 + length])
    metadata = header.pop("__metadata__")
    tensors = {}
    for name, tensor in header.items():
        begin, end = tensor["data_offsets"]
        values = np.frombuffer(data[8 + length + begin : 8 + length + end], "<f4")
        tensors[name] = values.reshape(tensor["shape"])
    return tensors, json.loads(metadata["footwork"])


def layer(about, tensors, x):
    weight, bias = tensors[about["name"] + ".weight"], tensors[about["name"] + ".bias"]
    if about["kind"] == "dense":
        x = x.reshape(len(x), -1) @ weight.T + bias
    else:
        stride = about["stride"]
        windows = np.lib.stride_tricks.sliding_window_view(x, weight.shape[2:], axis=(2, 3))
        windows = windows[:, :, ::stride, ::stride]
        x = np.einsum("nchwij,fcij->nfhw", windows, weight) + bias[:, None, None]
    return ACTIVATIONS[about["activation"]](x)


def network(about, tensors, vector, maps):
    name = about["name"]
    if "clip" in about:
        clip = about["clip"]
        vector = np.clip((vector - tensors[f"{name}.mean"]) * tensors[f"{name}.inv_std"], -clip, clip)
        if maps is not None:
            maps = (maps - tensors[f"{name}.maps_mean"]) * tensors[f"{name}.maps_inv_std"]
            maps = np.clip(maps, -clip, clip)
    if maps is not None:
        for one in about.get("maps", []):
            maps = layer(one, tensors, maps)
        vector = np.concatenate([vector, maps.reshape(len(maps), -1)], axis=1)
    for one in about["layers"]:
        vector = layer(one, tensors, vector)
    return vector


def check(path):
    tensors, about = load(path)

    def recorded(port):
        values = np.fromfile(path.with_suffix(f".{port['name']}.f32"), "<f4")
        return values.reshape(-1, *port["shape"])

    inputs = [recorded(port) for port in about["inputs"]]
    vectors = [values for values in inputs if values.ndim == 2]
    maps = [values for values in inputs if values.ndim == 4]
    found = network(about["networks"][0], tensors, np.concatenate(vectors, axis=1), maps[0] if maps else None)
    action = next(port for port in about["outputs"] if port["name"] == "action")
    worst = np.abs(found - recorded(action)).max()
    print(f"{path.stem}: off by {worst:.1e}")
    assert worst <= LARGEST, f"{path.name} is off by {worst}"


if __name__ == "__main__":
    for path in sorted(Path(sys.argv[1]).glob("*.safetensors")):
        check(path)
