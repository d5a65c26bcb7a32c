// Axes and shapes of the plots.
#include "host/app/plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/app/plot_axis.h"

namespace partita::app::plot {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> labels(const Axis& axis, std::size_t count) {
  std::vector<std::string> result;
  for (const Tick& tick : axis.ticks(count)) result.push_back(tick.label);
  return result;
}

TEST(PlotAxis, TicksAreRoundNumbers) {
  EXPECT_THAT(labels(Axis(3, 17.5, 0, 100), 5), ElementsAre("5", "10", "15"));
  EXPECT_THAT(labels(Axis(0.02, 0.05, 0, 100), 4), ElementsAre("0.02", "0.03", "0.04", "0.05"));
  EXPECT_THAT(labels(Axis(12, 480, 0, 100), 8), ElementsAre("20", "50", "100", "200", "500"));
  EXPECT_THAT(labels(Axis(1.5, 2e6, 0, 100), 6),
              ElementsAre("1", "10", "100", "1000", "10000", "100000", "1e+06"));
}

TEST(PlotAxis, EveryValueIsInsideAndInOrder) {
  for (const auto& [least, most] : std::vector<std::pair<double, double>>{
           {3, 17.5}, {12, 480}, {5, 5}, {0, 0}, {0, 3}, {-2, 9}}) {
    const Axis axis(least, most, 500, 20);
    EXPECT_LE(axis(least), 500);
    EXPECT_GE(axis(most), 20);
    EXPECT_GE(axis(least), axis(most));
  }
  EXPECT_TRUE(Axis(1, 100, 0, 1).logarithmic());
  EXPECT_FALSE(Axis(0, 100, 0, 1).logarithmic());
}

TEST(PlotAxis, StepsAre125) {
  EXPECT_DOUBLE_EQ(nice_step(10, 10), 1);
  EXPECT_DOUBLE_EQ(nice_step(11, 10), 2);
  EXPECT_DOUBLE_EQ(nice_step(0.3, 10), 0.05);
  EXPECT_DOUBLE_EQ(nice_step(900, 10), 100);
}

TEST(Plot, SvgHoldsTheShapesAndEscapesText) {
  Drawing drawing(200, 100, "a & b");
  drawing.add(Line{{{1, 2}, {3.456, 4}}, kInk, 1.5, true});
  drawing.add(Box{.from = {5, 6}, .width = 7, .height = 8, .fill = {1, 2, 3}});
  drawing.add(Mark{.at = {50, 50}, .radius = 4});
  drawing.add(Text{{10, 20}, "x < y", 14, Anchor::middle});
  const std::string svg = drawing.to_svg();
  for (const char* part :
       {"<title>a &amp; b</title>", "points=\"1,2 3.46,4\"", "stroke-dasharray",
        "<rect x=\"5\" y=\"6\" width=\"7\" height=\"8\" fill=\"#010203\"/>",
        "<circle cx=\"50\" cy=\"50\" r=\"4\"", "text-anchor=\"middle\"", ">x &lt; y</text>"}) {
    EXPECT_THAT(svg, HasSubstr(part));
  }
}

TEST(Plot, PngIsOneAndTheSameTwice) {
  Drawing drawing(200, 100, "shapes");
  drawing.add(Mark{.at = {50, 50}, .radius = 20, .star = true});
  drawing.add(Text{.at = {10, 60}, .text = "upright", .upright = true});
  drawing.add(Text{.at = {195, 99}, .text = "beyond the page"});
  const std::string png = drawing.to_png();
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(png, drawing.to_png());
}

TEST(Plot, ColoursGetLighter) {
  EXPECT_EQ(lighter(kBlack, 1), kWhite);
  EXPECT_EQ(lighter(series(0), 0), series(0));
}

}  // namespace
}  // namespace partita::app::plot
