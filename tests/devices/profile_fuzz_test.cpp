// Mutated profiles and records: whatever the bytes, the loaders return or throw their own error.
#include <fstream>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/devices/mutate.h"
#include "tests/devices/timeline_programs.h"

namespace partita {
namespace {

using testing::expect_one_line;
using testing::mutated;

TEST(Fuzz, ProfilesLoadOrThrowOneLine) {
  std::mt19937 random(1);
  for (const char* name : {"gtx1060", "zcu102", "cortex-a53"}) {
    std::ifstream in(std::string(PARTITA_SOURCE_DIR "/profiles/devices/") + name + ".yaml");
    std::stringstream text;
    text << in.rdbuf();
    int refused = 0;
    for (int i = 0; i < 400; ++i) {
      try {
        profile::parse_device(mutated(text.str(), random), "fuzz.yaml");
      } catch (const profile::Error& e) {
        ++refused;
        expect_one_line(e.what());
      }
    }
    EXPECT_GT(refused, 100) << name;
  }
}

TEST(Fuzz, RecordsReplayOrThrowOneLine) {
  std::mt19937 random(2);
  timeline::test::ProgramOptions options;
  options.steps = 40;
  options.threads = 2;
  std::stringstream good;
  timeline::write_record(timeline::test::run_programs(8, 8, options), good);
  int refused = 0, replayed = 0;
  for (int i = 0; i < 4000; ++i) {
    std::stringstream text(mutated(good.str(), random));
    try {
      const timeline::Record record = timeline::read_record(text, "fuzz.jsonl");
      timeline::replay(record);
      ++replayed;
    } catch (const profile::Error& e) {
      ++refused;
      expect_one_line(e.what());
    }
  }
  EXPECT_GT(refused, 500);
  EXPECT_GT(replayed, 100);
}

}  // namespace
}  // namespace partita
