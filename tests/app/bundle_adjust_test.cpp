// partita bundle-adjust as a user calls it.
#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/io/bal.h"
#include "host/tasks/backend/cases.h"
#include "tests/app/spawn.h"
#include "tests/host/io_temp_folder.h"

namespace partita::testing {
namespace {

using ::testing::HasSubstr;

/// A small problem as a file.
std::string problem_file(const TempFolder& folder) {
  const backend::Problem problem =
      backend::random_problem(backend::CameraModel::bal, 6, 120, 4, 21);
  io::BalProblem bal;
  bal.cameras = problem.cameras;
  bal.points = problem.points;
  for (const backend::Observation& o : problem.observations) {
    bal.observations.push_back({o.camera, o.point, o.measured[0], o.measured[1]});
  }
  io::write_bal(folder.file("problem.txt"), bal);
  return folder.file("problem.txt");
}

TEST(BundleAdjust, PrintsTheFivePartsAndWritesTheResult) {
  const TempFolder folder;
  const std::string problem = problem_file(folder), adjusted = folder.file("adjusted.txt");
  const Outcome outcome =
      partita({"bundle-adjust", problem, "-o", adjusted, "--json", folder.file("a.json")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* word : {"JU", "SE", "CFS", "CC", "GRE", "paper", "51.00", "29.80", "10.45"}) {
    EXPECT_THAT(outcome.out, HasSubstr(word));
  }
  const auto json = nlohmann::json::parse(bytes_of(folder.file("a.json")));
  EXPECT_LT(json["final_cost"], json["initial_cost"]);
  EXPECT_GT(json["iterations"], 0);
  EXPECT_GT(json["total_seconds"], 0.0);
  EXPECT_EQ(json["parts"].size(), 5u);
  // The written problem begins where the other one ended.
  const auto again = partita_json({"bundle-adjust", adjusted, "--iterations", "0"});
  EXPECT_NEAR(again["initial_cost"], json["final_cost"], 1e-9 * json["final_cost"].get<double>());
}

TEST(BundleAdjust, OursAndCeresEndAlike) {
  const TempFolder folder;
  const std::string problem = problem_file(folder);
  const auto ours = partita_json({"bundle-adjust", problem, "--loss", "huber"});
  const auto ceres =
      partita_json({"bundle-adjust", problem, "--loss", "huber", "--solver", "ceres"});
  const double expected = ceres["final_cost"];
  EXPECT_NEAR(ours["initial_cost"], ceres["initial_cost"],
              1e-9 * ceres["initial_cost"].get<double>());
  EXPECT_LT(ours["final_cost"], expected * (1 + 1e-4));
  const auto single =
      partita_json({"bundle-adjust", problem, "--loss", "huber", "--variant", "fpga"});
  EXPECT_LT(single["final_cost"], expected * (1 + 1e-3));
}

/// Every device of the emulated machine, the FPGA from a container that the command packages.
TEST(BundleAdjust, RunsOnEmulatedDevicesWithPredictedTimes) {
  const TempFolder folder;
  const std::string problem = problem_file(folder);
  for (const char* device : {"gpu", "fpga"}) {
    const auto json = partita_json({"bundle-adjust", problem, "--machine", "dragonfly", "--device",
                                    device, "--iterations", "2"});
    EXPECT_EQ(json["precision"], std::string(device) == "gpu" ? "double" : "single");
    for (const char* part : {"JU", "SE", "CFS", "CC", "GRE"}) {
      EXPECT_GT(json["predicted_parts"][part], 0.0) << device << " " << part;
    }
  }
}

TEST(BundleAdjust, SaysWhatIsWrongInOneLine) {
  const TempFolder folder;
  const std::string problem = problem_file(folder);
  const std::string out = folder.file("out.txt");
  std::filesystem::resize_file(problem, std::filesystem::file_size(problem) / 2);
  expect_one_line(partita({"bundle-adjust", problem, "-o", out}), 3, {"problem.txt:", "cut short"});
  EXPECT_FALSE(std::filesystem::exists(out));
  expect_one_line(partita({"bundle-adjust", folder.file("no.txt")}), 3, {"no.txt"});
  expect_one_line(partita({"bundle-adjust"}), 2, {"PROBLEM", "--help"});
  expect_one_line(partita({"bundle-adjust", problem, "--loss", "tukey"}), 2, {"--loss"});
  expect_one_line(partita({"bundle-adjust", problem, "--function-tolerance", "nan"}), 2,
                  {"--function-tolerance"});
}

TEST(BundleAdjust, TellsOfPointsBehindTheirCameras) {
  const TempFolder folder;
  io::BalProblem bal = io::read_bal(problem_file(folder));
  bal.points[static_cast<std::size_t>(bal.observations[0].point)][2] += 40;
  io::write_bal(folder.file("behind.txt"), bal);
  const Outcome outcome =
      partita({"bundle-adjust", folder.file("behind.txt"), "--iterations", "1"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("behind.txt:2: point "));
  EXPECT_THAT(outcome.err, HasSubstr("lies behind camera"));
}

}  // namespace
}  // namespace partita::testing
