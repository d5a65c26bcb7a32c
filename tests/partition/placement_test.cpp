#include "partition/placement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/profile/error.h"

namespace partita::partition {
namespace {

const Placement kDefaults{{"fpga", "gpu"}};

TEST(Placement, ReadsBranchesInAnyOrderAndKeepsDefaults) {
  EXPECT_EQ(parse_placement("", kDefaults).to_string(), "localization=fpga,scene=gpu");
  EXPECT_EQ(parse_placement("scene=cpu", kDefaults).to_string(), "localization=fpga,scene=cpu");
  EXPECT_EQ(parse_placement("scene=cpu,localization=GTX 1060", kDefaults).of(Branch::localization),
            "GTX 1060");
  EXPECT_EQ(parse_placement(" scene = cpu , localization= GTX 1060 ", kDefaults).to_string(),
            "localization=GTX 1060,scene=cpu");
}

TEST(Placement, RefusesWhatCannotBeMeant) {
  for (const char* text : {"localisation=gpu", "localization", "localization=", "=gpu",
                           "scene= ", " ", "scene=gpu,,", "scene=gpu,scene=cpu", "frontend=fpga"}) {
    EXPECT_THROW(parse_placement(text, kDefaults), profile::Error) << text;
  }
}

TEST(Placement, SaysWhichTasksThereAre) {
  try {
    parse_placement("localisation=gpu", kDefaults);
    FAIL();
  } catch (const profile::Error& error) {
    EXPECT_STREQ(error.what(),
                 "placement: no task 'localisation', expected one of localization, scene");
  }
}

}  // namespace
}  // namespace partita::partition
