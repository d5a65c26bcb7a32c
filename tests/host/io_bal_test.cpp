// Reading and writing Bundle Adjustment in the Large: exact, and every damage named by its line.
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/io/bal.h"
#include "host/io/file.h"
#include "tests/host/io_temp_folder.h"

namespace partita::io {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::TempFolder;

const std::string kValid =
    "2 2 3\n"
    "0 0 -3.5e+01 2.5\n"
    "1 0 4 5\n"
    "1 1 6 7\n"
    "0.1\n0.2\n0.3\n1\n2\n-30\n500\n-1e-7\n1e-13\n"
    "0 0 0 0 0 -30\n600 0 0\n"
    "1 2 3\n"
    "-1 -2 -3\n";

TEST(Bal, ReadsAndWritesBackExactly) {
  const TempFolder folder;
  const BalProblem problem = read_bal(folder.write("a.txt", kValid));
  ASSERT_EQ(problem.cameras.size(), 2u);
  ASSERT_EQ(problem.observations.size(), 3u);
  EXPECT_EQ(problem.observations[0].x, -35);
  EXPECT_EQ(problem.observations[2].point, 1);
  EXPECT_EQ(problem.lines, (std::vector<std::size_t>{2, 3, 4}));
  EXPECT_EQ(problem.cameras[0][7], -1e-7);
  EXPECT_EQ(problem.points[1][2], -3);
  write_bal(folder.file("b.txt"), problem);
  const BalProblem again = read_bal(folder.file("b.txt"));
  EXPECT_EQ(again.cameras, problem.cameras);
  EXPECT_EQ(again.points, problem.points);
}

TEST(Bal, NamesTheLineOfWhatIsWrong) {
  const TempFolder folder;
  const auto error = [&](const std::string& from, const std::string& to) {
    std::string text = kValid;
    text.replace(text.find(from), from.size(), to);
    return error_of([&] { read_bal(folder.write("a.txt", text)); });
  };
  EXPECT_THAT(error("1 0 4 5", "2 0 4 5"),
              HasSubstr("a.txt:3: an observation's camera 2, expected 0 to 1"));
  EXPECT_THAT(error("1 1 6 7", "1 -1 6 7"), HasSubstr("a.txt:4: an observation's point -1"));
  EXPECT_THAT(error("6 7", "6 x"), HasSubstr("a.txt:4: 'x' is not a number"));
  EXPECT_THAT(error("4 5", "4 nan"), HasSubstr("a.txt:3: 'nan' where a finite number"));
  EXPECT_THAT(error("500", "1e999"), HasSubstr("a.txt:11: '1e999'"));
  EXPECT_THAT(error("2 2 3", "2.5 2 3"), HasSubstr("a.txt:1: '2.5' where the number of cameras"));
  EXPECT_THAT(error("2 2 3", "0 2 3"), HasSubstr("a.txt:1: the number of cameras 0"));
  EXPECT_THAT(error("2 2 3", "2 2 999999999"), HasSubstr("a.txt:1: the number of observations"));
  EXPECT_THAT(error("-3\n", "-3\n4\n"), HasSubstr("a.txt:18: '4' behind the last point"));
  EXPECT_THAT(error("-1 -2 -3\n", "-1 -2\n"), HasSubstr("the file is cut short"));
  EXPECT_THAT(error_of([&] { read_bal(folder.write("e.txt", "")); }), HasSubstr("e.txt:1:"));
  EXPECT_THAT(error_of([&] { read_bal(folder.file("none.txt")); }), HasSubstr("none.txt"));
}

TEST(Bal, FindsPointsBehindTheirCamera) {
  const TempFolder folder;
  BalProblem problem = read_bal(folder.write("a.txt", kValid));
  EXPECT_EQ(find_behind(problem).count, 0u);
  problem.points[1][2] = 40;  // z = 10 in camera 1
  const Behind behind = find_behind(problem);
  EXPECT_EQ(behind.count, 1u);
  EXPECT_EQ(behind.first, 2u);
}

TEST(Bal, EndsInAValueOrAnErrorWhateverItReads) {
  const TempFolder folder;
  std::mt19937 random(7);
  const std::vector<std::string> words = {
      "nan", "-", "1e999", "\n", " ", "99999999999999999999", "0x1", "\xff", std::string(1, '\0'),
      "-1",  "."};
  int refused = 0;
  constexpr int kRounds = 4000;
  for (int round = 0; round < kRounds; ++round) {
    std::string text = kValid;
    for (std::size_t edits = 1 + random() % 3; edits > 0; --edits) {
      const std::size_t at = random() % (text.size() + 1);
      switch (random() % 4) {
        case 0:
          text.insert(at, words[random() % words.size()]);
          break;
        case 1:
          text.erase(at, random() % 12);
          break;
        case 2:
          if (at < text.size()) text[at] = static_cast<char>(random() % 256);
          break;
        default:
          text.resize(at);
      }
    }
    const std::string path = folder.write("fuzz.txt", text);
    try {
      const BalProblem problem = read_bal(path);
      find_behind(problem);
    } catch (const Error& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(refused, kRounds / 2);
  EXPECT_LT(refused, kRounds);
}

}  // namespace
}  // namespace partita::io
