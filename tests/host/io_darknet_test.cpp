// Darknet's files: shapes of every layer, complaints that name what is wrong, and thousands of
// damaged files.
#include <cmath>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/io/darknet.h"
#include "host/io/file.h"
#include "host/runtime/error.h"
#include "tests/host/darknet_networks.h"
#include "tests/host/fuzz_text.h"
#include "tests/host/io_temp_folder.h"

namespace partita::io::darknet {
namespace {

using partita::testing::error_of;
using partita::testing::kEveryLayerCfg;
using ::testing::HasSubstr;
using ::testing::StartsWith;

Model every_layer() {
  return parse_cfg(kEveryLayerCfg, "net.cfg");
}

TEST(Cfg, GivesEveryLayersShape) {
  const Model model = every_layer();
  ASSERT_EQ(model.layers.size(), 26u);
  EXPECT_EQ(model.input, (Extent{52, 36, 3}));
  EXPECT_EQ(model.layers[0].out, (Extent{26, 18, 20}));
  EXPECT_EQ(model.layers[1].pad, 2);  // pad=1: half the window
  EXPECT_EQ(model.layers[5].out, (Extent{13, 9, 20}));
  EXPECT_EQ(model.layers[7].out, (Extent{13, 9, 12}));
  EXPECT_EQ(model.layers[9].out, (Extent{13, 9, 24}));
  EXPECT_EQ(model.layers[9].inputs, (std::vector<int>{8, 7}));
  EXPECT_EQ(model.layers[10].out, (Extent{13, 9, 24}));  // size 3, stride 1 keeps the size
  EXPECT_EQ(model.layers[13].out, (Extent{13, 9, 72}));
  EXPECT_EQ(model.layers[17].activation, Activation::relu);
  const Yolo& yolo = model.layers[19].yolo;
  EXPECT_EQ(yolo.mask, (std::vector<int>{2, 3}));
  EXPECT_FLOAT_EQ(yolo.scale_x_y, 1.05F);
  EXPECT_FLOAT_EQ(yolo.anchors[2].height, 58);
  EXPECT_EQ(model.layers[23].out, (Extent{26, 18, 29}));
  EXPECT_EQ(model.layers[23].inputs, (std::vector<int>{22, 4}));
}

TEST(Cfg, TakesAnotherSideForItsPictures) {
  EXPECT_EQ(parse_cfg(kEveryLayerCfg, "net.cfg", 64).layers[0].out, (Extent{32, 32, 20}));
}

struct BadCfg {
  const char* from;  ///< replaced, once
  const char* to;
  const char* complaint;
};

class BadCfgs : public ::testing::TestWithParam<BadCfg> {};

TEST_P(BadCfgs, AreNamed) {
  std::string text = kEveryLayerCfg;
  const std::size_t at = text.find(GetParam().from);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, std::strlen(GetParam().from), GetParam().to);
  const std::string message = error_of([&] { parse_cfg(text, "net.cfg"); });
  EXPECT_THAT(message, StartsWith("net.cfg"));
  EXPECT_THAT(message, HasSubstr(GetParam().complaint));
}

INSTANTIATE_TEST_SUITE_P(
    Errors, BadCfgs,
    ::testing::Values(
        BadCfg{"[maxpool]", "[avgpool]", ":37: [avgpool]: not a known layer"},
        BadCfg{"[maxpool]", "[max pool]", ":37: section '[max pool]' is not known"},
        BadCfg{"stride=2", "strife=2", ":12: [convolutional] has an option 'strife'"},
        BadCfg{"stride=2", "stride=two", ":12: [convolutional] stride='two': expected a whole"},
        BadCfg{"stride=2", "stride=0", "expected a whole number from 1 to"},
        BadCfg{"stride=2", "stride=2\nstride=2", ":13: 'stride' is given twice"},
        BadCfg{"stride=2", "stride", "'stride' is no option, expected KEY=VALUE"},
        BadCfg{"activation=leaky", "activation=snake", "activation='snake': expected linear"},
        BadCfg{"groups=20", "groups=3", "3 groups divide neither"},
        BadCfg{"from=-4", "from=-9", "this is layer 4: expected layers from 0 to 3"},
        BadCfg{"from=6", "from=0", "layer 0 is 26 x 18 x 20, expected 13 x 9 x 24"},
        BadCfg{"from=6", "from=6,7", "from='6,7': expected one layer"},
        BadCfg{"layers=-1,4", "layers=-1,6", "they cannot be joined"},
        BadCfg{"layers=-1,4", "layers=", "expected a whole number"},
        BadCfg{"group_id=1", "group_id=2", "expected a whole number from 0 to 1"},
        BadCfg{"size=5\nstride=1\npad=1", "size=55",
               "a window of 55 does not fit an input of 26 x 18 x 20"},
        BadCfg{"classes=2", "classes=3", "14 channels come in, expected 16"},
        BadCfg{"num=4", "num=5", "8 numbers, expected 2 for each of num=5"},
        BadCfg{"mask = 2,3", "mask = 2,4", "expected a whole number from 0 to 3"},
        BadCfg{"num=4", "num=4\nnew_coords=1", "not supported, expected 0"},
        BadCfg{"width=52", "width=nan", ":4: [net] width='nan'"},
        BadCfg{"width=52", "", "no option 'width'"},
        BadCfg{"[net]", "[convolutional]", "expected [net] first"},
        BadCfg{"[net]", "", "an option before the first section"},
        BadCfg{"filters=20", "filters=99999999", "expected a whole number from 1 to 65536"}));

TEST(Cfg, NeedsLayersAndText) {
  EXPECT_THAT(error_of([] { parse_cfg("", "a.cfg"); }), HasSubstr("a.cfg: no section"));
  EXPECT_THAT(error_of([] { parse_cfg("[net]\nwidth=8\nheight=8\n", "a.cfg"); }),
              HasSubstr("no layer after [net]"));
  EXPECT_THAT(error_of([] { parse_cfg(std::string(4, '\0'), "a.cfg"); }),
              HasSubstr("not a text file"));
  EXPECT_THAT(error_of([] { read_cfg("/nonexistent/a.cfg"); }), HasSubstr("/nonexistent/a.cfg"));
}

TEST(Weights, ComeBackAsWritten) {
  const Model model = every_layer();
  const Weights weights = random_weights(model, 7);
  const partita::testing::TempFolder folder;
  const std::string path = folder.write("net.weights", format_weights(weights));
  const Weights read = read_weights(path, model);
  ASSERT_EQ(read.size(), weights.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].weights, weights[i].weights) << i;
    EXPECT_EQ(read[i].biases, weights[i].biases) << i;
    EXPECT_EQ(read[i].variances, weights[i].variances) << i;
  }
  EXPECT_NE(random_weights(model, 8)[0].weights, weights[0].weights);
}

TEST(Weights, OfVersion01HaveAShorterHeader) {
  const Model model = every_layer();
  std::string bytes = format_weights(random_weights(model, 1));
  const Weights wanted = parse_weights(bytes, "w", model);
  bytes.erase(16, 4);
  bytes[4] = 1;  // the minor version
  EXPECT_EQ(parse_weights(bytes, "w", model)[0].weights, wanted[0].weights);
}

TEST(Weights, ThatDoNotFitAreNamed) {
  const Model model = every_layer();
  const std::string good = format_weights(random_weights(model, 1));
  const auto complaint = [&](const std::string& bytes) {
    return error_of([&] { parse_weights(bytes, "net.weights", model); });
  };
  EXPECT_THAT(complaint(""), HasSubstr("0 bytes, expected a header of at least 16"));
  EXPECT_THAT(complaint(good.substr(0, 15)), HasSubstr("15 bytes"));
  EXPECT_THAT(complaint(good.substr(0, good.size() - 4)),
              HasSubstr("ends in layer 24 (net.cfg:123)"));
  EXPECT_THAT(complaint(good.substr(0, 400)), HasSubstr("ends in layer 0 (net.cfg:8)"));
  EXPECT_THAT(complaint(good + "abcd"), HasSubstr("4 bytes more than the"));
  EXPECT_THAT(complaint(good + "a"), HasSubstr("weights of another network"));
  EXPECT_THAT(complaint("\xff\xff\xff\xff" + good.substr(4)), HasSubstr("version -1.2"));
  const auto with = [&](std::size_t number, float value) {
    std::string bytes = good;
    std::memcpy(&bytes[20 + 4 * number], &value, sizeof value);
    return complaint(bytes);
  };
  EXPECT_THAT(with(3, NAN), HasSubstr("layer 0: bias 3 of 20 is nan, expected a finite number"));
  EXPECT_THAT(with(85, std::numeric_limits<float>::infinity()),
              HasSubstr("layer 0: weight 5 of 540 is inf"));
  EXPECT_THAT(with(61, -1.0F), HasSubstr("layer 0: variance 1 is -1"));
}

const std::vector<std::string> kWords = {
    "nan", "-",  "1e999", "\n",   " ",   "",     "=",       ",",  "#",         "[yolo]",    "-1",
    "0",   "99", "[",     "]\n[", "x\n", "\xff", "groups=", "2,", "[route]\n", "9999999999"};

/// How many of the mutations were refused.
template <class Read>
int refused_of(const std::string& valid, int rounds, Read read) {
  return partita::testing::refused_mutations(valid, kWords, rounds, read);
}

TEST(DarknetFuzz, Cfg) {
  EXPECT_GT(refused_of(kEveryLayerCfg, 4000, [](const auto& text) { parse_cfg(text, "a.cfg"); }),
            1500);
}

TEST(DarknetFuzz, Weights) {
  const Model model = every_layer();
  const std::string good = format_weights(random_weights(model, 1));
  EXPECT_GT(refused_of(good, 1000, [&](const auto& bytes) { parse_weights(bytes, "w", model); }),
            500);
}

}  // namespace
}  // namespace partita::io::darknet
