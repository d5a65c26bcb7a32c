#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/io/file.h"
#include "host/io/json_file.h"
#include "host/io/output_folder.h"
#include "host/io/text.h"
#include "tests/host/io_temp_folder.h"

namespace partita::io {
namespace {

using ::testing::AllOf;
using testing::error_of;
using ::testing::HasSubstr;
using testing::TempFolder;
namespace fs = std::filesystem;

TEST(AtomicFile, AppearsWholeWithCommit) {
  const TempFolder folder;
  const std::string path = folder.file("a.txt");
  write_file(path, "old");
  AtomicFile file(path);
  file.write("new ");
  EXPECT_EQ(read_file(path), "old");
  file.write("content");
  file.commit();
  EXPECT_EQ(read_file(path), "new content");
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(AtomicFile, LeavesNothingBehindWithoutCommit) {
  const TempFolder folder;
  { AtomicFile(folder.file("a.txt")).write("half"); }
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(AtomicFile, FullDiskNamesThePathAndLeavesNoFile) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const TempFolder folder;
  const std::string path = folder.file("a.txt");
  fs::create_symlink("/dev/full", AtomicFile::temporary_path(path));
  const std::string small = error_of([&] { write_file(path, "x"); });
  EXPECT_THAT(small, AllOf(HasSubstr(path), HasSubstr("No space left")));
  EXPECT_EQ(folder.entries(), 0U);
  fs::create_symlink("/dev/full", AtomicFile::temporary_path(path));
  const std::string large = error_of([&] { write_file(path, std::string(1 << 20, 'x')); });
  EXPECT_THAT(large, AllOf(HasSubstr(path), HasSubstr("No space left")));
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(AtomicFile, UnwritableFolderNamesThePath) {
  const TempFolder folder;
  const std::string file = folder.write("file", "");
  EXPECT_THAT(error_of([&] { write_file(file + "/below.txt", "x"); }),
              HasSubstr(file + "/below.txt"));
  EXPECT_THAT(error_of([&] { write_file(folder.path(), "x"); }), HasSubstr("directory"));
  EXPECT_THAT(error_of([&] { write_file("/proc/partita.txt", "x"); }),
              HasSubstr("/proc/partita.txt"));
}

TEST(ReadFile, NamesWhatIsMissingOrAFolder) {
  const TempFolder folder;
  EXPECT_THAT(error_of([&] { read_file(folder.file("none")); }), HasSubstr("none"));
  EXPECT_THAT(error_of([&] { read_file(folder.path()); }), HasSubstr(folder.path()));
}

TEST(OutputFolder, IsMarkedUntilComplete) {
  const TempFolder folder;
  OutputFolder out(folder.file("deep/run"), kRunWriter);
  EXPECT_TRUE(is_partial(out.path()));
  out.complete();
  EXPECT_FALSE(is_partial(out.path()));
  OutputFolder again(out.path(), kRunWriter);
  EXPECT_TRUE(is_partial(out.path()));
}

TEST(OutputFolder, TheMarkSaysWhoseItIs) {
  const TempFolder folder;
  const OutputFolder out(folder.path(), kGenerateWriter);
  EXPECT_TRUE(is_partial(folder.path(), kGenerateWriter));
  EXPECT_FALSE(is_partial(folder.path(), kRunWriter));
  folder.write("PARTIAL", "a differential equation");
  EXPECT_TRUE(is_partial(folder.path()));
  EXPECT_FALSE(is_partial(folder.path(), kGenerateWriter));
  EXPECT_FALSE(is_partial(folder.path(), kRunWriter));
}

TEST(OutputFolder, SeriesForgetsAnEarlierRunsFiles) {
  const TempFolder folder;
  folder.write("disparity/000050.png", "old");
  folder.write("disparity/notes.txt", "mine");
  folder.write("disparity/my_truth.png", "mine");
  const OutputFolder out(folder.path(), kRunWriter);
  const std::string series = out.series("disparity", ".png");
  EXPECT_FALSE(fs::exists(series + "/000050.png"));
  EXPECT_TRUE(fs::exists(series + "/notes.txt"));
  EXPECT_TRUE(fs::exists(series + "/my_truth.png"));
}

TEST(OutputFolder, RefusesWhatIsNoFolderOrNotWritable) {
  const TempFolder folder;
  const std::string file = folder.write("file", "");
  EXPECT_THAT(error_of([&] { OutputFolder(file, kRunWriter); }), HasSubstr(file));
  EXPECT_THAT(error_of([&] { OutputFolder(file + "/below", kRunWriter); }),
              HasSubstr(file + "/below"));
  EXPECT_THAT(error_of([&] { OutputFolder("/proc/partita", kRunWriter); }),
              HasSubstr("/proc/partita"));
}

TEST(Json, RoundTripAndLineOfAnError) {
  const TempFolder folder;
  const nlohmann::ordered_json value = {{"z", 1}, {"a", {1.5, "text"}}};
  write_json(folder.file("a.json"), value);
  EXPECT_EQ(read_json(folder.file("a.json")).dump(), value.dump());
  const std::string bad = folder.write("bad.json", "{\n \"a\": 1,\n nonsense\n}\n");
  EXPECT_THAT(error_of([&] { read_json(bad); }), HasSubstr(bad + ":3:"));
}

TEST(TextFile, RowsAndNumbers) {
  const TempFolder folder;
  const TextFile file(folder.write("a.txt", "# head\n1 2e0\t+3\r\n\n-4 5 6 # tail\n1e-400 0 0"));
  ASSERT_EQ(file.rows().size(), 3U);
  EXPECT_EQ(file.rows()[1].line, 4U);
  EXPECT_EQ(file.numbers(file.rows()[0], 0, 3, "three"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(file.number(file.rows()[2], 0), 0.0);
}

TEST(TextFile, RefusesWithFileAndLine) {
  const TempFolder folder;
  const TextFile file(folder.write("a.txt", "1 2\n3 x\n4 nan\n5 1e999\n6 inf\n"));
  const auto message = [&](std::size_t row, std::size_t count) {
    return error_of([&] { file.numbers(file.rows()[row], 0, count, "what is meant"); });
  };
  EXPECT_THAT(message(0, 3), HasSubstr("a.txt:1: 2 numbers, expected what is meant"));
  EXPECT_THAT(message(1, 2), HasSubstr("a.txt:2: 'x' is not a number"));
  EXPECT_THAT(message(2, 2), HasSubstr("a.txt:3: 'nan'"));
  EXPECT_THAT(message(3, 2), HasSubstr("a.txt:4: '1e999'"));
  EXPECT_THAT(message(4, 2), HasSubstr("a.txt:5: 'inf'"));
}

}  // namespace
}  // namespace partita::io
