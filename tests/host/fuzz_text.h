// Random edits to text for the readers of files: whatever the bytes, a reader accepts them or
// refuses them in one line.
#ifndef PARTITA_TESTS_HOST_FUZZ_TEXT_H
#define PARTITA_TESTS_HOST_FUZZ_TEXT_H

#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/runtime/error.h"

namespace partita::testing {

/// One to four edits: one of `words` put in, some bytes taken out, a byte changed, the end cut off.
inline std::string mutated_text(std::string text, const std::vector<std::string>& words,
                                std::mt19937& random) {
  const auto pick = [&random](std::size_t size) { return random() % size; };
  for (std::size_t edits = 1 + pick(4); edits > 0; --edits) {
    const std::size_t at = pick(text.size() + 1);
    switch (pick(4)) {
      case 0:
        text.insert(at, words[pick(words.size())]);
        break;
      case 1:
        text.erase(at, pick(12));
        break;
      case 2:
        if (at < text.size()) text[at] = static_cast<char>(pick(256));
        break;
      default:
        text.resize(pick(4) == 0 ? at : text.size());
    }
  }
  return text;
}

/// How many of `rounds` mutations of `valid` were refused by `read`.
template <class Read>
int refused_mutations(const std::string& valid, const std::vector<std::string>& words, int rounds,
                      Read read) {
  std::mt19937 random(12345);
  int refused = 0;
  for (int i = 0; i < rounds; ++i) {
    const std::string text = mutated_text(valid, words, random);
    try {
      read(text);
    } catch (const Error& e) {
      ++refused;
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    }
  }
  return refused;
}

}  // namespace partita::testing

#endif  // PARTITA_TESTS_HOST_FUZZ_TEXT_H
