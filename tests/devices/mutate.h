// Random edits to a text file, for tests that no reader takes the process down, whatever the bytes.
#ifndef PARTITA_TESTS_DEVICES_MUTATE_H
#define PARTITA_TESTS_DEVICES_MUTATE_H

#include <algorithm>
#include <iterator>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace partita::testing {

/// A few random edits: flipped, dropped, doubled and moved bytes, lines and numbers.
inline std::string mutated(std::string text, std::mt19937& random) {
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

inline void expect_one_line(const std::string& message) {
  EXPECT_FALSE(message.empty());
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

}  // namespace partita::testing

#endif  // PARTITA_TESTS_DEVICES_MUTATE_H
