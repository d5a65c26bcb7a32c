// What explore, diff and the profiles that they read refuse: one clear line and a status.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/spawn.h"
#include "tests/host/io_temp_folder.h"

namespace partita::testing {
namespace {

namespace fs = std::filesystem;

class BadQuestion : public ::testing::Test {
 protected:
  Outcome explore(std::vector<std::string> more, const Environment& environment = {}) const {
    std::vector<std::string> words{"explore", "--quiet", "--out", temp_.file("out")};
    if (std::find(more.begin(), more.end(), "--from") == more.end()) {
      words.emplace_back("--no-execute");
    }
    words.insert(words.end(), more.begin(), more.end());
    return partita(words, environment);
  }
  void TearDown() override { EXPECT_FALSE(fs::exists(temp_.file("out"))); }

  /// A copy of the profiles in which a file has `from` replaced by `to`.
  Environment changed(const std::string& file, const std::string& from, const std::string& to) {
    fs::copy(PARTITA_SOURCE_PROFILES, temp_.file("profiles"), fs::copy_options::recursive);
    const std::string path = temp_.file("profiles/" + file);
    std::string text = bytes_of(path);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    std::ofstream(path) << text.replace(at, from.size(), to);
    return {{"PARTITA_PROFILES", temp_.file("profiles")}};
  }

  TempFolder temp_;
};

TEST_F(BadQuestion, NamesThatAreNotThere) {
  expect_one_line(explore({"--machine", "firefly"}), 3, {"firefly", "dragonfly", "tx2"});
  expect_one_line(explore({"--pipeline", "racing"}), 3, {"racing", "dragonfly", "perception"});
  expect_one_line(explore({"--pin", "parking=gpu"}), 3, {"parking", "frontend", "localization"});
  expect_one_line(explore({"--pin", "depth=npu"}), 3, {"npu", "zcu102 (fpga)", "gtx1060 (gpu)"});
  expect_one_line(explore({"--machine", "native"}), 2, {"native"});
  expect_one_line(explore({"--machine", "tx2", "--machine", "tx2"}), 2, {"tx2", "twice"});
  expect_one_line(explore({"--objective", "fun"}), 2, {"fun", "latency", "cost"});
}

TEST_F(BadQuestion, PinsThatContradictEachOther) {
  expect_one_line(explore({"--pin", "depth=gpu", "--pin", "scene=cpu"}), 3,
                  {"'scene=cpu'", "contradicts", "depth=gpu"});
  expect_one_line(explore({"--pin", "depth"}), 2, {"'depth'", "TASK=DEVICE"});
}

TEST_F(BadQuestion, LimitsThatNobodyCanMeet) {
  expect_one_line(explore({"--limit", "power=3W"}), 3,
                  {"machine 'dragonfly'", "power=3 W", "the least is 1", "by sensing="});
  expect_one_line(explore({"--limit", "price=400", "--limit", "latency=60ms"}), 3,
                  {"price=400 USD", "the least is"});
}

TEST_F(BadQuestion, LimitsThatAreNone) {
  expect_one_line(explore({"--limit", "power"}), 2, {"'power'", "power=30"});
  expect_one_line(explore({"--limit", "weight=3"}), 2, {"weight", "price"});
  expect_one_line(explore({"--limit", "power=-3W"}), 2, {"more than 0"});
  expect_one_line(explore({"--limit", "power=3km"}), 2, {"km"});
  expect_one_line(explore({"--limit", "power=3W", "--limit", "power=4W"}), 2, {"twice"});
}

TEST_F(BadQuestion, AVehicleThatNobodyHas) {
  expect_one_line(explore({"--speed", "0"}), 2, {"--speed"});
  expect_one_line(explore({"--battery", "nan"}), 2, {"--battery"});
  expect_one_line(explore({"--base-power", "-1"}), 2, {"--base-power"});
}

TEST_F(BadQuestion, AFolderWithoutARun) {
  expect_one_line(explore({"--from", temp_.path()}), 3, {temp_.path(), "work.json"});
  expect_one_line(explore({"--from", temp_.file("nowhere")}), 3, {"nowhere", "work.json"});
  temp_.write("run/work.json", "{\"tool\": \"partita\", \"origin\"");
  expect_one_line(explore({"--from", temp_.file("run")}), 3, {"run/work.json:1"});
}

TEST_F(BadQuestion, APipelineThatGoesRoundInCircles) {
  const std::string text =
      bytes_of(std::string(PARTITA_SOURCE_PROFILES) + "/pipelines/dragonfly.yaml");
  const std::string from = "inputs: [frontend.features]";
  std::string circle = text;
  circle.replace(circle.find(from), from.size(), "inputs: [frontend.features, planning.command]");
  expect_one_line(explore({"--pipeline", temp_.write("circle.yaml", circle)}), 3,
                  {"circle.yaml", "backend", "planning"});
}

TEST_F(BadQuestion, ProfilesWithNumbersThatCannotBe) {
  const Environment zero = changed("devices/gtx1060.yaml", "units: ", "units: 0 # ");
  expect_one_line(explore({}, zero), 3, {"gtx1060.yaml:", "units"});
}

TEST_F(BadQuestion, AreasThatAreNone) {
  const auto areas = [&](const std::string& text) {
    return explore({"--areas", temp_.write("areas.json", text)});
  };
  expect_one_line(areas("{"), 3, {"areas.json"});
  expect_one_line(areas(R"({"parking": {"lut": 1}})"), 3, {"parking"});
  expect_one_line(areas(R"({"planning": {"lut": 1}})"), 3, {"planning"});
  expect_one_line(areas(R"({"depth": {"luts": 1}})"), 3, {"luts", "bram36"});
  expect_one_line(areas(R"({"depth": {"lut": -1}})"), 3, {"lut is -1"});
}

TEST(BadOutput, AFolderThatCannotBeWrittenOrIsSomebodyElses) {
  const TempFolder temp;
  const auto explore = [](const std::string& out) {
    return partita({"explore", "--no-execute", "--quiet", "--machine", "tx2", "--out", out});
  };
  expect_one_line(explore("/proc/partita"), 5, {"/proc/partita"});
  temp.write("thesis.txt", "years of work");
  expect_one_line(explore(temp.path()), 5, {temp.path(), "--force"});
  expect_one_line(explore(temp.file("thesis.txt/out")), 5, {"thesis.txt' is not a folder"});
  EXPECT_EQ(temp.entries(), 1u);
}

TEST(BadDiff, WhatCannotBeCompared) {
  const TempFolder temp;
  partita_json({"explore", "--no-execute", "--quiet", "--machine", "tx2", "--out", temp.file("a")});
  temp.write("run/summary.json",
             R"({"tool": "partita", "placement": {}, "accuracy": {}, "predicted": {}})");
  temp.write("other/summary.json", R"({"tool": "something else"})");
  temp.write("broken/explore.json", R"({"tool": "partita", "kind": "exploration"})");
  const auto diff = [&](const std::string& b) {
    return partita({"diff", temp.file("a"), temp.file(b)});
  };
  expect_one_line(diff("run"), 3, {"a/explore.json", "exploration", "run/summary.json", "a run"});
  expect_one_line(diff("other"), 3, {"other/summary.json"});
  expect_one_line(diff("broken"), 3, {"broken/explore.json", "cannot be compared"});
  expect_one_line(diff("nowhere"), 3, {"nowhere"});
  expect_one_line(partita({"diff", temp.path(), temp.file("a")}), 3, {"holds neither"});
  expect_one_line(partita({"diff", temp.file("a")}), 2, {"B"});
}

}  // namespace
}  // namespace partita::testing
