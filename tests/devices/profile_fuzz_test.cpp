// Mutated profiles and records: whatever the bytes, the loaders return or throw their own error.
#include <fstream>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/devices/timeline_programs.h"

namespace partita {
namespace {

/// A few random edits: flipped, dropped, doubled and moved bytes, lines and numbers.
std::string mutated(std::string text, std::mt19937& random) {
  static const char* const kTokens[] = {"-1",        "1e308", "99999999999999999999",
                                        "[",         "]",     "{",
                                        "}",         ":",     "null",
                                        "\"",        "\n",    "&a ",
                                        "*a",        "- ",    "true",
                                        "0",         ",",     "#",
                                        "4294967295"};
  for (int edits = 1 + static_cast<int>(random() % 4); edits > 0 && !text.empty(); --edits) {
    const std::size_t at = random() % text.size();
    const std::size_t length = std::min<std::size_t>(text.size() - at, 1 + random() % 20);
    switch (random() % 7) {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, text.substr(random() % text.size(), length));
        break;
      case 3:
        text.insert(at, kTokens[random() % std::size(kTokens)]);
        break;
      case 4:
        text.replace(at, 1, kTokens[random() % std::size(kTokens)]);
        break;
      case 5:
        text.resize(at);
        break;
      default: {  // another number where one was
        const auto digit = text.find_first_of("0123456789", at);
        if (digit == std::string::npos) break;
        const auto end = text.find_first_not_of("0123456789.", digit);
        text.replace(digit, (end == std::string::npos ? text.size() : end) - digit,
                     std::to_string(random() % 3 == 0 ? random() : random() % 12));
      }
    }
  }
  return text;
}

void expect_one_line(const std::string& message) {
  EXPECT_FALSE(message.empty());
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

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
