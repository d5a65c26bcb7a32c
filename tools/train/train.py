#!/usr/bin/python3
"""Trains the street detector on folders written by `partita generate`.

  tools/train/train.py --cfg profiles/detectors/street/street.cfg --size 512x288 DIR...

Needs Debian's python3-torch and python3-opencv. The same options on the same machine give the same
weights. --checkpoint FILE keeps the state and goes on from it.
"""
import argparse
import os
import time

import numpy as np
import torch
from torch.nn import functional

from dataset import Street, scaled_anchors
from darknet import Network

RATIO = 3.0  # of sides: an anchor is responsible for boxes no further from its own size
BALANCE = {8: 4.0, 16: 1.0}  # weight of a scale's objectness, by its stride


def assign(head, stride, boxes, width, height):
    """The numbers that are to become one of the boxes: rows of image, anchor, y, x and box.

    boxes: rows of image, class, centre x, centre y, width, height in pixels. Beside the cell of the
    centre, the nearest neighbour along each axis learns the box too (scale_x_y lets it reach)."""
    anchors = torch.from_numpy(head.anchors)
    rows = []
    for a, anchor in enumerate(anchors):
        ratio = boxes[:, 4:6] / anchor
        fits = torch.maximum(ratio, 1 / ratio).max(1).values < RATIO
        rows.append(torch.cat([boxes[fits], torch.full((int(fits.sum()), 1), float(a))], 1))
    chosen = torch.cat(rows)
    centre = chosen[:, 2:4] / stride
    cell = centre.floor()
    nearer = torch.where(centre - cell < 0.5, -1.0, 1.0)
    cells = [cell] + [cell + nearer * torch.tensor(axis) for axis in ([1.0, 0.0], [0.0, 1.0])]
    chosen = chosen.repeat(3, 1)
    cell = torch.cat(cells)
    inside = ((cell >= 0) & (cell < torch.tensor([width, height]))).all(1)
    return chosen[inside], cell[inside].long()


def overlap(a, b):
    """Generalised IoU of boxes given by centre and size."""
    low = torch.maximum(a[:, :2] - a[:, 2:] / 2, b[:, :2] - b[:, 2:] / 2)
    high = torch.minimum(a[:, :2] + a[:, 2:] / 2, b[:, :2] + b[:, 2:] / 2)
    common = (high - low).clamp(min=0).prod(1)
    union = a[:, 2:].prod(1) + b[:, 2:].prod(1) - common
    hull = (torch.maximum(a[:, :2] + a[:, 2:] / 2, b[:, :2] + b[:, 2:] / 2)
            - torch.minimum(a[:, :2] - a[:, 2:] / 2, b[:, :2] - b[:, 2:] / 2)).prod(1)
    iou = common / union
    return iou, iou - (hull - union) / hull


def head_loss(head, raw, boxes, ignored, stride):
    batch, _, height, width = raw.shape
    raw = raw.view(batch, len(head.mask), 5 + head.classes, height, width).permute(0, 1, 3, 4, 2)
    wanted, cell = assign(head, stride, boxes, width, height)
    image, anchor = wanted[:, 0].long(), wanted[:, 6].long()
    target = torch.zeros(raw.shape[:4])
    weight = torch.ones(raw.shape[:4])
    for i, x0, y0, x1, y1 in ignored:  # what is there is neither to be found nor wrong
        weight[int(i), :, int(y0 / stride):int(y1 / stride) + 1,
               int(x0 / stride):int(x1 / stride) + 1] = 0
    box_loss = class_loss = raw.sum() * 0
    if len(wanted):
        predicted = raw[image, anchor, cell[:, 1], cell[:, 0]]
        s = head.scale_x_y
        centre = (predicted[:, :2].sigmoid() * s - (s - 1) / 2 + cell) * stride
        size = predicted[:, 2:4].clamp(-4, 4).exp() * torch.from_numpy(head.anchors)[anchor]
        iou, giou = overlap(torch.cat([centre, size], 1), wanted[:, 2:6])
        box_loss = (1 - giou).mean()
        classes = functional.one_hot(wanted[:, 1].long(), head.classes).float()
        class_loss = functional.binary_cross_entropy_with_logits(predicted[:, 5:], classes)
        place = (image, anchor, cell[:, 1], cell[:, 0])
        target[place] = iou.detach().clamp(min=0.0)
        weight[place] = 1
    objectness = functional.binary_cross_entropy_with_logits(raw[..., 4], target, weight)
    return 2.0 * box_loss + 30.0 * BALANCE[stride] * objectness + 0.5 * class_loss


def rate(step, steps, highest):
    """Warm up, hold, and fall linearly over the last two fifths."""
    return highest * min(1.0, (step + 1) / 200, max(0.01, (steps - step) / (0.4 * steps)))


class Average:
    """The exponential mean of a network's numbers, which is what is kept."""

    def __init__(self, network):
        self.values = {k: v.clone() for k, v in network.state_dict().items()}

    def update(self, network, step):
        keep = min(0.998, (1 + step) / (20 + step))
        for key, value in network.state_dict().items():
            mean = self.values[key]
            mean.copy_(mean * keep + value * (1 - keep) if mean.is_floating_point() else value)


def network_of(options):
    network = Network(options.cfg)
    if options.size:
        network.width, network.height = (int(side) for side in options.size.split("x"))
    return network


def train(options):
    torch.manual_seed(options.seed)
    torch.set_num_threads(options.threads)
    network = network_of(options)
    data = Street(options.data, network.width, network.height, options.seed)
    print(f"{len(data)} pictures, {data.count} objects, "
          f"{sum(p.numel() for p in network.parameters())} parameters", flush=True)
    for head in network.heads:  # few objects among many cells at the start
        with torch.no_grad():
            bias = network.layers[head.layer].conv.bias.view(len(head.mask), -1)
            bias[:, 4] = -5.0
            bias[:, :4] = 0.0
    decayed = [p for p in network.parameters() if p.dim() > 1]
    others = [p for p in network.parameters() if p.dim() <= 1]
    optimiser = torch.optim.AdamW([{"params": decayed, "weight_decay": 5e-3},
                                   {"params": others, "weight_decay": 0.0}])
    average = Average(network)
    first = 0
    if options.checkpoint and os.path.exists(options.checkpoint):
        state = torch.load(options.checkpoint)
        network.load_state_dict(state["network"])
        optimiser.load_state_dict(state["optimiser"])
        average.values = state["average"]
        first = state["step"]

    def save(step):
        if options.checkpoint:
            state = {"network": network.state_dict(), "optimiser": optimiser.state_dict(),
                     "average": average.values, "step": step}
            torch.save(state, options.checkpoint + ".new")
            os.replace(options.checkpoint + ".new", options.checkpoint)
        kept = Network(options.cfg)
        kept.load_state_dict(average.values)
        kept.write_weights(options.out, step * options.batch)

    network.train()
    mean, begin = 0.0, time.process_time()
    for step in range(first, options.steps):
        for group in optimiser.param_groups:
            group["lr"] = rate(step, options.steps, options.rate)
        pictures, boxes, ignored = data.batch(step, options.batch)
        raw = network(pictures)
        loss = sum(head_loss(head, r, boxes, ignored, network.width // r.shape[3])
                   for head, r in zip(network.heads, raw))
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 10.0)
        optimiser.step()
        average.update(network, step)
        mean = loss.item() if step == first else 0.98 * mean + 0.02 * loss.item()
        if (step + 1) % 50 == 0:
            print(f"step {step + 1}/{options.steps} loss {mean:.3f} "
                  f"{time.process_time() - begin:.0f} s of processor time", flush=True)
        if (step + 1) % 100 == 0 or step + 1 == options.steps:
            save(step + 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("data", nargs="+", help="folders written by partita generate")
    parser.add_argument("--cfg", required=True)
    parser.add_argument("--out", default="street.weights", help="where the weights go")
    parser.add_argument("--size", help="WIDTHxHEIGHT of the pictures while learning, multiples of "
                        "32 (default: as in the cfg)")
    parser.add_argument("--steps", type=int, default=3000)
    parser.add_argument("--batch", type=int, default=8)
    parser.add_argument("--rate", type=float, default=2e-3, help="highest learning rate")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--checkpoint", help="keep the state here and go on from it")
    parser.add_argument("--anchors", action="store_true",
                        help="only print six anchors for these data: k-means of the box sizes")
    options = parser.parse_args()
    if options.anchors:
        print(scaled_anchors(options.data, network_of(options)))
    else:
        train(options)


if __name__ == "__main__":
    main()
