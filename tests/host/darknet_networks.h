// A small network that has every layer and activation, for tests without data.
#ifndef PARTITA_TESTS_HOST_DARKNET_NETWORKS_H
#define PARTITA_TESTS_HOST_DARKNET_NETWORKS_H

namespace partita::testing {

inline constexpr const char* kEveryLayerCfg = R"(# every layer and activation
[net]
batch=1
width=52
height = 36
channels=3

[convolutional]
batch_normalize=1
filters=20
size=3
stride=2
pad=1
activation=leaky

[convolutional]
batch_normalize=1
filters=20
groups=20
size=5
stride=1
pad=1
activation=swish

[convolutional]
filters=20
size=1
activation=linear

[dropout]
probability=.2

[shortcut]
from=-4
activation=linear

[maxpool]
size=2
stride=2

; layer 6: two groups that are no depthwise convolution
[convolutional]
batch_normalize=1
filters=24
groups=2
size=3
stride=1
pad=1
activation=mish

[route]
layers=-1
groups=2
group_id=1

[convolutional]
filters=12
size=3
pad=1
activation=relu6

[route]
layers = -1,-2

[maxpool]
stride=1
size=3

[route]
layers=-2

[maxpool]
stride=1
size=5

[route]
layers=-1,-3,-4

[convolutional]
filters=24
size=1
activation=logistic

[shortcut]
from=6
activation=linear

[maxpool]
size=2
stride=1

[shortcut]
from=-2
activation=relu

[convolutional]
filters=14
size=1
activation=linear

[yolo]
mask = 2,3
anchors = 10,14, 23,27, 37,58, 81,82
classes=2
num=4
scale_x_y=1.05

[route]
layers=-4

[convolutional]
batch_normalize=1
filters=9
size=1
activation=relu

[upsample]
stride=2

[route]
layers=-1,4

[convolutional]
filters=14
size=3
pad=1
activation=linear

[yolo]
mask = 0,1
anchors = 10,14, 23,27, 37,58, 81,82
classes=2
num=4
)";

}  // namespace partita::testing

#endif  // PARTITA_TESTS_HOST_DARKNET_NETWORKS_H
