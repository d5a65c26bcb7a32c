// Parameters by name: every one can be set to what its table says, and to nothing else.
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/runtime/error.h"
#include "host/tasks/depth/parameters.h"

namespace partita::depth {
namespace {

using testing::HasSubstr;

std::string error_of(std::string_view name, std::string_view value) {
  DepthParameters parameters;
  try {
    set_parameter(parameters, name, value);
  } catch (const Error& error) {
    EXPECT_EQ(parameters, DepthParameters{}) << "an error changes nothing";
    return error.what();
  }
  return "no error";
}

TEST(DepthParameters, BothSettingsAreInRange) {
  for (const std::string_view name : kSettings) EXPECT_NO_THROW(check_parameters(setting(name)));
  EXPECT_EQ(setting("robotics"), DepthParameters{});
  EXPECT_TRUE(setting("middlebury").add_corners);
  EXPECT_EQ(plane_radius(setting("robotics")), 2);
  EXPECT_EQ(plane_radius(setting("middlebury")), 3);
}

TEST(DepthParameters, ASettingNobodyKnowsIsRefused) {
  EXPECT_THAT(
      [] { setting("kitti"); },
      testing::ThrowsMessage<Error>(HasSubstr("'kitti', expected one of robotics, middle")));
}

TEST(DepthParameters, EachIsSetByNameToItsLimitsAndNotBeyond) {
  for (const Parameter& parameter : parameter_table()) {
    SCOPED_TRACE(parameter.name);
    EXPECT_FALSE(parameter.meaning.empty());
    for (const double value : {parameter.least, parameter.most}) {
      DepthParameters parameters;
      set_parameter(parameters, parameter.name, fmt::format("{}", value));
      EXPECT_EQ(parameter.get(parameters), value);
    }
    const double beyond = parameter.most + 1;
    const double below = parameter.least - 1;
    EXPECT_THAT(error_of(parameter.name, fmt::format("{}", beyond)), HasSubstr(parameter.name));
    EXPECT_THAT(error_of(parameter.name, fmt::format("{}", below)), HasSubstr("expected"));
    for (const char* text : {"", "x", "1x", "nan", " 1", "1e999"}) {
      EXPECT_THAT(error_of(parameter.name, text), HasSubstr("expected")) << text;
    }
  }
}

TEST(DepthParameters, FlagsTakeWordsAndWholeNumbersTakeNoFractions) {
  DepthParameters parameters;
  set_parameter(parameters, "add_corners", "on");
  EXPECT_TRUE(parameters.add_corners);
  set_parameter(parameters, "add_corners", "false");
  EXPECT_FALSE(parameters.add_corners);
  EXPECT_EQ(error_of("candidate_step", "5.5"),
            "depth: candidate_step is '5.5', expected a whole number from 5 to 32 px");
  EXPECT_EQ(error_of("filter_median", "2"), "depth: filter_median is '2', expected on or off");
  EXPECT_THAT(error_of("grid", "20"), HasSubstr("no parameter 'grid', expected one of max_disp"));
}

TEST(DepthParameters, APlaneIsNotSearchedTooFar) {
  DepthParameters parameters;
  parameters.sigma = 10;
  parameters.sradius = 2;
  EXPECT_THAT([&] { check_parameters(parameters); },
              testing::ThrowsMessage<Error>(HasSubstr("20 px, expected at most 16")));
}

}  // namespace
}  // namespace partita::depth
