#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/io/file.h"
#include "host/io/json_file.h"
#include "host/io/trace.h"
#include "tests/host/io_temp_folder.h"

namespace partita::io {
namespace {

using testing::TempFolder;
using Json = nlohmann::ordered_json;

TEST(Trace, HoldsProcessesLanesEventsAndCounters) {
  const TempFolder folder;
  const std::string path = folder.file("trace.json");
  TraceWriter trace(path);
  const int predicted = trace.process("predicted");
  const int measured = trace.process("measured");
  const auto fpga = trace.lane(predicted, "ZCU102: fast");
  const auto thread = trace.lane(measured, "localization");
  trace.complete(fpga, "fast \"quoted\"", "kernel", 1'234'567, 89, {{"frame", 3}});
  trace.complete(thread, "bad \xff byte", "host", -1'500, 0);
  trace.counter(predicted, "queue depth", 2'000, 4.0);
  EXPECT_FALSE(std::filesystem::exists(path));
  trace.close();

  const Json events = read_json(path).at("traceEvents");
  std::vector<Json> complete;
  std::vector<Json> counters;
  std::map<std::string, std::string> names;
  for (const Json& e : events) {
    if (e["ph"] == "X") complete.push_back(e);
    if (e["ph"] == "C") counters.push_back(e);
    if (e["name"] == "thread_name" || e["name"] == "process_name") {
      names[e["args"]["name"]] =
          std::to_string(e["pid"].get<int>()) + "/" + std::to_string(e.value("tid", 0));
    }
  }
  ASSERT_EQ(complete.size(), 2U);
  EXPECT_EQ(complete[0]["ts"].get<double>(), 1234.567);
  EXPECT_EQ(complete[0]["dur"].get<double>(), 0.089);
  EXPECT_EQ(complete[0]["args"]["frame"], 3);
  EXPECT_EQ(complete[1]["ts"].get<double>(), -1.5);
  ASSERT_EQ(counters.size(), 1U);
  EXPECT_EQ(counters[0]["args"]["value"], 4.0);
  EXPECT_EQ(names["predicted"], "1/0");
  EXPECT_EQ(names["measured"], "2/0");
  EXPECT_EQ(names["ZCU102: fast"], "1/1");
  EXPECT_EQ(names["localization"], "2/1");
}

TEST(Trace, KeepsNanosecondsAfterDays) {
  const TempFolder folder;
  TraceWriter trace(folder.file("t.json"));
  trace.complete(trace.lane(trace.process("p"), "l"), "e", "c", 864'000'000'000'001, 1);
  trace.close();
  EXPECT_NE(read_file(folder.file("t.json")).find("\"ts\":864000000000.001,"), std::string::npos);
}

TEST(Trace, WithoutCloseNothingIsLeft) {
  const TempFolder folder;
  { TraceWriter(folder.file("t.json")).process("p"); }
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(Trace, FullDiskIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const TempFolder folder;
  const std::string path = folder.file("t.json");
  std::filesystem::create_symlink("/dev/full", AtomicFile::temporary_path(path));
  const std::string message = testing::error_of([&] {
    TraceWriter trace(path);
    const auto lane = trace.lane(trace.process("p"), "l");
    for (int i = 0; i < 10000; ++i) trace.complete(lane, "event", "c", i, 1);
    trace.close();
  });
  EXPECT_THAT(message, ::testing::HasSubstr(path));
}

}  // namespace
}  // namespace partita::io
