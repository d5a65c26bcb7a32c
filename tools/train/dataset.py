"""Pictures and labels of `partita generate`, in memory, as batches for training."""
import glob
import os

import cv2
import numpy as np
import torch

CLASSES = ["Car", "Pedestrian", "Cyclist"]
SMALLEST = 5.0  # px of height in the network's input; what is smaller is ignored
LEAST_LEFT = 0.35  # of a box, for what a crop leaves of it to count


def read_labels(path, scale):
    """Rows of class (-1: ignore), x0, y0, x1, y1."""
    rows = []
    with open(path, encoding="ascii") as file:
        for line in file:
            fields = line.split()
            kind = CLASSES.index(fields[0]) if fields[0] in CLASSES else -1
            rows.append([kind, *[float(v) * scale for v in fields[4:8]]])
    return np.array(rows, np.float32).reshape(-1, 5)


class Street:
    def __init__(self, folders, width, height, seed):
        self.width, self.height, self.seed = width, height, seed
        self.pictures, self.labels = [], []
        for folder in folders:
            for path in sorted(glob.glob(os.path.join(folder, "image_0", "*.png"))):
                picture = cv2.imread(path, cv2.IMREAD_GRAYSCALE)
                name = os.path.splitext(os.path.basename(path))[0] + ".txt"
                scale = width / picture.shape[1]
                labels = read_labels(os.path.join(folder, "label_2", name), scale)
                self.pictures.append(cv2.resize(picture, (width, height)))
                self.labels.append(labels)
        if not self.pictures:
            raise SystemExit("no pictures: expected folders written by partita generate")
        self.count = sum(len(labels) for labels in self.labels)

    def __len__(self):
        return len(self.pictures)

    def batch(self, step, size):
        """Depends on nothing but the step: training can stop and go on."""
        epoch = (step * size) // len(self)
        pictures, boxes, ignored = [], [], []
        for i in range(size):
            number = step * size + i
            epoch, place = divmod(number, len(self))
            order = np.random.default_rng([self.seed, epoch]).permutation(len(self))
            random = np.random.default_rng([self.seed, 1, number])
            picture, labels = self.varied(order[place], random)
            pictures.append(picture)
            for kind, x0, y0, x1, y1 in labels:
                if kind < 0 or y1 - y0 < SMALLEST:
                    ignored.append((i, x0, y0, x1, y1))
                else:
                    boxes.append((i, kind, (x0 + x1) / 2, (y0 + y1) / 2, x1 - x0, y1 - y0))
        stack = torch.from_numpy(np.stack(pictures))[:, None].expand(-1, 3, -1, -1)
        return stack, torch.tensor(boxes, dtype=torch.float32).reshape(-1, 6), ignored

    def varied(self, index, random):
        """Mirrored, moved, larger or smaller, brighter or darker."""
        picture, labels = self.pictures[index], self.labels[index].copy()
        scale = np.exp(random.uniform(-0.25, 0.35))
        left = random.uniform(min(0, self.width * (1 - scale)), max(0, self.width * (1 - scale)))
        top = random.uniform(min(0, self.height * (1 - scale)), max(0, self.height * (1 - scale)))
        mirrored = random.random() < 0.5
        x_scale = -scale if mirrored else scale
        left = left + scale * self.width if mirrored else left
        # Pixel centres lie at half pixels: x' = x_scale * (x + 0.5) + left - 0.5.
        matrix = np.array([[x_scale, 0, left + 0.5 * x_scale - 0.5],
                           [0, scale, top + 0.5 * scale - 0.5]], np.float64)
        picture = cv2.warpAffine(picture, matrix, (self.width, self.height), flags=cv2.INTER_LINEAR,
                                 borderMode=cv2.BORDER_CONSTANT, borderValue=127)
        gain, offset = random.uniform(0.75, 1.25), random.uniform(-0.08, 0.08)
        picture = np.clip(picture.astype(np.float32) * (gain / 255) + offset, 0, 1)
        if not len(labels):
            return picture, labels
        xs = labels[:, [1, 3]] * x_scale + left
        ys = labels[:, [2, 4]] * scale + top
        x0, x1 = xs.min(1), xs.max(1)
        area = (x1 - x0) * (ys[:, 1] - ys[:, 0])
        labels[:, 1], labels[:, 3] = np.clip(x0, 0, self.width), np.clip(x1, 0, self.width)
        labels[:, 2] = np.clip(ys[:, 0], 0, self.height)
        labels[:, 4] = np.clip(ys[:, 1], 0, self.height)
        left_over = (labels[:, 3] - labels[:, 1]) * (labels[:, 4] - labels[:, 2])
        labels[left_over < LEAST_LEFT * area, 0] = -1
        return picture, labels[left_over > 0]


def scaled_anchors(folders, network):
    """Six anchors by k-means of the logarithms of the boxes' sizes, smallest first."""
    data = Street(folders, network.width, network.height, 1)
    labels = np.concatenate(data.labels)
    sizes = labels[labels[:, 0] >= 0][:, 3:5] - labels[labels[:, 0] >= 0][:, 1:3]
    sizes = np.log(sizes[sizes[:, 1] >= SMALLEST])
    centres = np.quantile(sizes, np.linspace(0.05, 0.95, 6), axis=0)
    for _ in range(100):
        nearest = ((sizes[:, None] - centres[None]) ** 2).sum(2).argmin(1)
        centres = np.array([sizes[nearest == k].mean(0) for k in range(len(centres))])
    anchors = np.exp(centres)
    anchors = anchors[anchors.prod(1).argsort()]
    return ", ".join(f"{w:.0f},{h:.0f}" for w, h in anchors)
