"""A network described by a Darknet .cfg as a PyTorch module, and its .weights file.

Only the layers that the street detector uses: convolutional, shortcut, route, upsample, yolo.
"""
import struct

import numpy as np
import torch
from torch import nn
from torch.nn import functional


def read_cfg(path):
    """The sections of a .cfg in order: dictionaries of text, the section's name under "type"."""
    sections = []
    with open(path, encoding="utf-8") as file:
        for line in file:
            line = line.split("#")[0].strip()
            if line.startswith("["):
                sections.append({"type": line.strip("[]")})
            elif line:
                key, value = line.split("=", 1)
                sections[-1][key.strip()] = value.strip()
    return sections


def numbers(text, kind=int):
    return [kind(part) for part in text.split(",")]


class Convolution(nn.Module):
    def __init__(self, inputs, section):
        super().__init__()
        size = int(section["size"])
        self.normalised = int(section.get("batch_normalize", 0)) == 1
        self.activation = section["activation"]
        self.conv = nn.Conv2d(inputs, int(section["filters"]), size, int(section["stride"]),
                              size // 2 if int(section.get("pad", 0)) else 0,
                              groups=int(section.get("groups", 1)), bias=not self.normalised)
        if self.normalised:
            self.norm = nn.BatchNorm2d(int(section["filters"]), eps=1e-6, momentum=0.03)

    def forward(self, x):
        x = self.conv(x)
        if self.normalised:
            x = self.norm(x)
        return functional.leaky_relu(x, 0.1) if self.activation == "leaky" else x


class Head:
    """What a [yolo] section says: where its numbers come from and how they are decoded."""

    def __init__(self, layer, section):
        self.layer = layer  # the one before, whose output holds the numbers
        anchors = np.array(numbers(section["anchors"], float), np.float32).reshape(-1, 2)
        self.mask = numbers(section["mask"])
        self.anchors = anchors[self.mask]
        self.all_anchors = anchors
        self.classes = int(section["classes"])
        self.scale_x_y = float(section.get("scale_x_y", 1))


class Network(nn.Module):
    def __init__(self, path):
        super().__init__()
        self.sections = read_cfg(path)
        net = self.sections.pop(0)
        self.width, self.height = int(net["width"]), int(net["height"])
        self.layers = nn.ModuleList()
        self.heads = []
        channels = []
        before = int(net["channels"])
        for index, section in enumerate(self.sections):
            layer = nn.Identity()
            if section["type"] == "convolutional":
                layer = Convolution(before, section)
                before = int(section["filters"])
            elif section["type"] == "upsample":
                layer = nn.Upsample(scale_factor=int(section["stride"]), mode="nearest")
            elif section["type"] == "route":
                before = sum(channels[self.source(index, i)] for i in numbers(section["layers"]))
            elif section["type"] == "yolo":
                self.heads.append(Head(index - 1, section))
            elif section["type"] != "shortcut":
                raise ValueError(f"{path}: no layer [{section['type']}] here")
            self.layers.append(layer)
            channels.append(before)

    @staticmethod
    def source(index, number):
        return number if number >= 0 else index + number

    def forward(self, x):
        """The numbers that go into each yolo layer, [batch, anchors * (5 + classes), y, x]."""
        outputs = []
        for index, (section, layer) in enumerate(zip(self.sections, self.layers)):
            if section["type"] == "route":
                sources = [self.source(index, i) for i in numbers(section["layers"])]
                x = torch.cat([outputs[i] for i in sources], 1)
            elif section["type"] == "shortcut":
                x = x + outputs[self.source(index, int(section["from"]))]
            else:
                x = layer(x)
            outputs.append(x)
        return [outputs[head.layer] for head in self.heads]

    def write_weights(self, path, seen):
        with open(path, "wb") as file:
            file.write(struct.pack("<iiiq", 0, 2, 5, seen))
            for layer in self.layers:
                if not isinstance(layer, Convolution):
                    continue
                if layer.normalised:
                    norm = layer.norm
                    parts = [norm.bias, norm.weight, norm.running_mean, norm.running_var]
                else:
                    parts = [layer.conv.bias]
                for part in [*parts, layer.conv.weight]:
                    file.write(part.detach().numpy().astype("<f4").tobytes())
