// What every command owes its user: help with examples, --json, stable exit statuses, one-line
// errors.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/spawn.h"

namespace partita::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Help, EveryCommandHasExamplesAndJson) {
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"run"},
                                             {"explore"},
                                             {"diff"},
                                             {"devices"},
                                             {"emulate"},
                                             {"depth"},
                                             {"verify"},
                                             {"bench", "overhead"},
                                             {"bench", "start"},
                                             {"bench", "simulate"},
                                             {"bench", "peers"},
                                             {"bench", "detect"},
                                             {"package"},
                                             {"generate"},
                                             {"detect"},
                                             {"track"},
                                             {"localize"},
                                             {"bundle-adjust"}}) {
    std::vector<std::string> words = command;
    words.emplace_back("--help");
    const Outcome outcome = partita(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("Examples:\n  partita " + command.front()),
                                   HasSubstr("--json"), HasSubstr("Usage:")));
    EXPECT_EQ(outcome.err, "");
  }
}

TEST(Help, TheMainPageListsCommandsAndExitStatuses) {
  const Outcome outcome = partita({"--help"});
  EXPECT_EQ(outcome.status, 0);
  for (const char* command :
       {"run", "explore", "diff", "devices", "emulate", "depth", "detect", "track", "localize",
        "bundle-adjust", "verify", "bench", "package", "generate"}) {
    EXPECT_THAT(outcome.out, HasSubstr(std::string("\n  ") + command + " "));
  }
  EXPECT_THAT(outcome.out, HasSubstr("Exit status: 0"));
}

TEST(Help, Version) {
  const Outcome outcome = partita({"--version"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, ::testing::MatchesRegex("partita [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(Usage, WhatIsWrongIsSaidInOneLine) {
  expect_one_line(partita({}), 2, {"--help"});
  expect_one_line(partita({"rum"}), 2, {"'rum'", "run", "verify"});
  expect_one_line(partita({"run", "--frames", "many"}), 2, {"--frames", "partita run --help"});
  expect_one_line(partita({"run", "--frames", "0"}), 2, {"--frames"});
  expect_one_line(partita({"run", "--execute", "slow"}), 2, {"--execute"});
  expect_one_line(partita({"run", "--scenario", "--dataset", "x"}), 2, {"--dataset"});
  expect_one_line(partita({"run", "--no-such-option", "3"}), 2, {"--no-such-option 3"});
  expect_one_line(partita({"run", "--machine", "native", "--drop-late"}), 2, {"--drop-late"});
  expect_one_line(partita({"run", "--machine", "native", "--allow-source"}), 2, {"--allow-source"});
  expect_one_line(partita({"run", "--machine", "native", "--fault", "x"}), 2, {"--fault"});
  expect_one_line(partita({"emulate"}), 2, {"partita emulate -- "});
  expect_one_line(partita({"package"}), 2, {"--out"});
  expect_one_line(partita({"generate"}), 2, {"--out"});
}

TEST(Colour, OnlyOnATerminal) {
  const Outcome outcome = partita({"devices", "--machine", "native"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, Not(HasSubstr("\033")));
  EXPECT_THAT(partita({"rum"}).err, Not(HasSubstr("\033")));
}

TEST(Output, AFullStandardOutputIsAFailure) {
  // The shell connects stdout to a device on which every write fails for want of space.
  const int status = std::system(
      (std::string(PARTITA_BINARY) + " devices --machine native >/dev/full 2>/dev/null").c_str());
  EXPECT_EQ(WEXITSTATUS(status), 5);
}

TEST(Devices, JsonSaysWhatTheTableSays) {
  const auto json = partita_json({"devices", "--machine", "native"});
  ASSERT_FALSE(json["devices"].empty());
  const std::string name = json["devices"][0]["device"];
  EXPECT_FALSE(json["devices"][0]["emulated"]);
  EXPECT_THAT(partita({"devices", "--machine", "native"}).out, HasSubstr(name));
}

TEST(Devices, TheDragonflyHasItsThree) {
  const auto json = partita_json({"devices"});
  ASSERT_EQ(json["devices"].size(), 3u);
  std::map<std::string, nlohmann::json> by_profile;
  for (const auto& device : json["devices"]) by_profile[device["profile"]] = device;
  EXPECT_EQ(by_profile["zcu102"]["kind"], "fpga");
  EXPECT_EQ(by_profile["zcu102"]["takes"], "container");
  EXPECT_EQ(by_profile["zcu102"]["node"], "zynq");
  EXPECT_EQ(by_profile["gtx1060"]["kind"], "gpu");
  EXPECT_EQ(by_profile["gtx1060"]["node"], "pc");
  EXPECT_EQ(by_profile["i5-8500"]["kind"], "cpu");
}

TEST(Emulate, PassesTheCommandAndItsStatusOn) {
  EXPECT_EQ(partita({"emulate", "--", "sh", "-c", "exit 7"}).status, 7);
  const Outcome echo =
      partita({"emulate", "--", "sh", "-c", "echo \"$@\"", "x", "--json", "--", "-q"});
  EXPECT_EQ(echo.out, "--json -- -q\n");
  const Outcome environment = partita({"emulate", "--machine", "gpu-only", "--", "sh", "-c",
                                       "echo $OPENCL_LAYERS $PARTITA_MACHINE"});
  EXPECT_THAT(environment.out, AllOf(HasSubstr("libpartita_layer.so"), HasSubstr("gpu-only.yaml")));
  expect_one_line(partita({"emulate", "--", "no-such-program-anywhere"}), 127,
                  {"no-such-program-anywhere"});
  EXPECT_EQ(partita({"emulate", "--report", "--", "sh", "-c", "exit 7"}).status, 7);
}

TEST(Emulate, NativeTakesTheLayerAway) {
  const Outcome outcome =
      partita({"emulate", "--machine", "native", "--", "sh", "-c", "echo \"[$OPENCL_LAYERS]\""},
              {{"OPENCL_LAYERS", "/somewhere/libpartita_layer.so"}});
  EXPECT_EQ(outcome.out, "[]\n");
}

}  // namespace
}  // namespace partita::testing
