// `partita explore`: what it answers and writes, twice the same, with pins, limits and machines.
#include <csignal>
#include <filesystem>
#include <set>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/io/image.h"
#include "tests/app/spawn.h"
#include "tests/host/io_temp_folder.h"

namespace partita::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// No OpenCL is to be found: whoever asked for it would fail.
const Environment kNoOpenCL{{"OCL_ICD_VENDORS", "/nonexistent"}};

class Explore : public ::testing::Test {
 protected:
  std::vector<std::string> words(const std::string& out, std::vector<std::string> more) const {
    std::vector<std::string> all{"explore", "--no-execute", "--quiet", "--out", temp_.file(out)};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  json explore(const std::string& out, const std::vector<std::string>& more = {}) const {
    return partita_json(words(out, more), kNoOpenCL);
  }
  std::string bytes(const std::string& out, const std::string& file) const {
    return bytes_of(temp_.file(out + "/" + file));
  }
  static const json& first(const json& document) { return document["predicted"]["machines"][0]; }

  TempFolder temp_;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

constexpr const char* kFiles[] = {"explore.json", "explore.csv",  "pareto.svg", "pareto.png",
                                  "schedule.svg", "schedule.png", "trace.json"};

TEST_F(Explore, TheSameBytesTwiceAndWithoutOpenCL) {
  const json a = explore("a"), b = explore("b");
  EXPECT_EQ(a, b);
  for (const char* file : kFiles) EXPECT_EQ(bytes("a", file), bytes("b", file)) << file;
  EXPECT_EQ(json::parse(bytes("a", "explore.json")), a);
  EXPECT_FALSE(fs::exists(temp_.file("a/PARTIAL")));
  EXPECT_FALSE(fs::exists(temp_.file("a/work.json")));
  EXPECT_FALSE(a["partial"]);
}

TEST_F(Explore, TheDocumentSaysWhatWasAskedOfWhat) {
  const json document = explore("out", {"--limit", "power=60W", "--pin", "depth=gpu"});
  EXPECT_EQ(document["tool"], "partita");
  EXPECT_EQ(document["kind"], "exploration");
  const json& inputs = document["inputs"];
  EXPECT_EQ(inputs["pipeline"]["name"], "dragonfly");
  EXPECT_EQ(inputs["machines"][0]["profiles"].size(), 4u);
  for (const json& hash :
       {inputs["pipeline"]["hash"], inputs["workload"]["hash"], inputs["machines"][0]["hash"]}) {
    EXPECT_EQ(hash.get<std::string>().size(), 16u);
  }
  EXPECT_EQ(inputs["workload"]["origin"], "typical counts");
  EXPECT_THAT(inputs["workload"]["by_work_alone"], ::testing::Contains("backend"));
  EXPECT_THAT(inputs["workload"]["by_work_alone"], Not(::testing::Contains("depth")));
  EXPECT_EQ(document["options"]["pins"], json::array({"depth=gpu"}));
  EXPECT_EQ(document["options"]["limits"], json({{"power", "60 W"}}));
}

TEST_F(Explore, TheBestIsTheOptimumAndTheFrontHasIt) {
  const json document = explore("out");
  const json& machine = first(document);
  EXPECT_EQ(machine["method"], "enumeration");
  EXPECT_TRUE(machine["optimal"]);
  EXPECT_EQ(machine["gap"], 0);
  EXPECT_EQ(machine["placements"],
            machine["simulated"].get<int>() + machine["infeasible"].get<int>());
  int refused = 0;
  for (const json& refusal : machine["refusals"]) refused += refusal["count"].get<int>();
  EXPECT_EQ(refused, machine["infeasible"]);
  const json& best = machine["best"];
  bool found = false;
  for (const json& point : machine["front"]) {
    found = found || point["placement"] == best["placement"];
    if (point["score"]["dropped_share"] > 0) continue;
    EXPECT_GE(point["score"]["latency_p99_ns"], best["score"]["latency_p99_ns"]);
  }
  EXPECT_TRUE(found);
  EXPECT_NEAR(best["vehicle"]["added_stopping_m"],
              5.6e-9 * best["score"]["latency_p99_ns"].get<double>(), 1e-9);
  EXPECT_NEAR(best["vehicle"]["driving_hours"],
              6000 / (600 + best["score"]["power_w"].get<double>()), 1e-9);
}

TEST_F(Explore, TextSaysWhatTheDocumentSays) {
  const json document = explore("json");
  const Outcome outcome = partita(words("text", {}), kNoOpenCL);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err, "");
  const json& machine = first(document);
  const json& best = machine["best"];
  char p99[32], hours[32];
  std::snprintf(p99, sizeof p99, "p99 %.2f ms",
                best["score"]["latency_p99_ns"].get<double>() / 1e6);
  std::snprintf(hours, sizeof hours, "%.1f h of driving",
                best["vehicle"]["driving_hours"].get<double>());
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr(p99), HasSubstr(hours), HasSubstr("(predicted)"),
                    HasSubstr("typical counts"), HasSubstr("the optimum"), HasSubstr("backend *"),
                    HasSubstr("by its Work alone"), HasSubstr("critical path: "),
                    HasSubstr("busiest engine: "), HasSubstr("what would help: "),
                    HasSubstr("next best"), HasSubstr("Pareto front of dragonfly")));
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("not feasible: "), HasSubstr("does not fit zcu102")));
  for (const auto& [task, place] : best["placement"].items()) {
    EXPECT_THAT(outcome.out, ::testing::ContainsRegex(task + "( \\*)? +" +
                                                      place.get<std::string>().substr(0, 6)));
  }
  for (const std::string& line : lines_of(outcome.out)) {
    EXPECT_EQ(line.find('\033'), std::string::npos);
  }
}

TEST_F(Explore, ACsvLineForEachPlacementOfTheFronts) {
  const json document = explore("out", {"--machine", "tx2,gpu-only"});
  const std::vector<std::string> lines = lines_of(bytes("out", "explore.csv"));
  ASSERT_FALSE(lines.empty());
  EXPECT_EQ(lines[0],
            "machine,best,joint_front,latency_p50_ns,latency_p99_ns,energy_j,power_w,throughput_hz,"
            "dropped_share,fpga_area_share,price_usd,added_stopping_m,driving_hours,sensing,"
            "frontend,backend,fusion,depth,detection,tracking,planning");
  std::size_t points = 0, joint = 0, best = 0;
  for (const json& machine : document["predicted"]["machines"]) points += machine["front"].size();
  EXPECT_EQ(lines.size(), points + 1);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    EXPECT_EQ(count(lines[i], ","), count(lines[0], ",")) << lines[i];
    best += count(lines[i], ",1,1,") + count(lines[i], ",1,0,");
    joint += count(lines[i], ",1,1,") + count(lines[i], ",0,1,");
  }
  EXPECT_EQ(best, 2u);
  EXPECT_EQ(joint, document["predicted"]["front"].size());
}

TEST_F(Explore, ThePlotsShowEverythingWithUnits) {
  const json document = explore("out");
  const std::string pareto = bytes("out", "pareto.svg");
  EXPECT_THAT(pareto, AllOf(StartsWith("<svg xmlns"), HasSubstr("end-to-end latency p99, ms"),
                            HasSubstr("energy per frame, J"), HasSubstr("(predicted)"),
                            HasSubstr("not dominated ("), HasSubstr("USD"),
                            HasSubstr("zcu102 + gtx1060"), HasSubstr("</svg>\n")));
  const json& machine = first(document);
  EXPECT_GT(count(pareto, "<circle "), machine["front"].size());
  EXPECT_EQ(count(pareto, "<polygon "), 2u);  // the best, and the sample of it
  const std::string schedule = bytes("out", "schedule.svg");
  for (const char* text : {"(predicted)", ">gtx1060<", "ms since the trigger of frame 45",
                           ">frame 46<", "backend *", "* by its Work alone"}) {
    EXPECT_THAT(schedule, HasSubstr(text));
  }
  for (const char* file : {"pareto.png", "schedule.png"}) {
    const io::GrayRead read = io::read_gray(temp_.file(std::string("out/") + file));
    EXPECT_GT(read.image.width, 2000) << file;
    EXPECT_GT(read.image.height, 500) << file;
  }
}

TEST_F(Explore, TheTraceHasTheFramesOfTheSchedule) {
  explore("out", {"--frames", "7"});
  const json trace = json::parse(bytes("out", "trace.json"));
  std::int64_t last = 0;
  for (const json& event : trace.is_array() ? trace : trace["traceEvents"]) {
    if (event.contains("args") && event["args"].contains("frame")) {
      last = std::max(last, event["args"]["frame"].get<std::int64_t>());
    }
  }
  EXPECT_EQ(last, 6);
}

TEST_F(Explore, PinsAndLimitsHold) {
  const json pinned = explore("a", {"--pin", "depth=cpu", "--pin", "localization=fpga"});
  EXPECT_EQ(first(pinned)["best"]["placement"]["depth"], "i5-8500");
  EXPECT_EQ(first(pinned)["best"]["placement"]["frontend"], "zcu102");
  EXPECT_EQ(first(pinned)["best"]["placement"]["backend"], "zcu102");
  const double power = first(explore("b"))["best"]["score"]["power_w"];
  const json limited = explore("c", {"--limit", "power=" + std::to_string(power - 0.1) + "W"});
  EXPECT_LE(first(limited)["best"]["score"]["power_w"], power - 0.1);
  EXPECT_GT(first(limited)["beyond_limits"], 0);
}

TEST_F(Explore, ObjectivesFindTheirOwnBest) {
  const auto score = [&](const char* objective) {
    return first(
        explore(objective, {"--objective", objective, "--machine", "gpu-only"}))["best"]["score"];
  };
  const json latency = score("latency"), energy = score("energy"), cost = score("cost");
  EXPECT_LE(latency["latency_p99_ns"], energy["latency_p99_ns"]);
  EXPECT_LE(energy["energy_j"], latency["energy_j"]);
  EXPECT_LE(cost["price_usd"], latency["price_usd"]);
  EXPECT_GE(score("throughput")["throughput_hz"], latency["throughput_hz"]);
}

TEST_F(Explore, MachinesAreRankedAndSomeHaveNoAnswer) {
  const Outcome outcome =
      partita(words("out", {"--machine", "all", "--limit", "power=45W"}), kNoOpenCL);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(
      outcome.out,
      AllOf(HasSubstr("against the first"), HasSubstr("behind by at least"),
            HasSubstr("no answer: machine 'h200': no placement meets power=45 W, the least")));
  const json document = json::parse(bytes("out", "explore.json"));
  const json& ranking = document["predicted"]["ranking"];
  EXPECT_LT(ranking.size(), document["predicted"]["machines"].size());
  EXPECT_LE(ranking[0]["value"], ranking[1]["value"]);
}

TEST_F(Explore, TheVehicleIsTheUsers) {
  const json document = explore(
      "out", {"--machine", "tx2", "--speed", "10", "--battery", "1000", "--base-power", "90"});
  const json& best = first(document)["best"];
  EXPECT_NEAR(best["vehicle"]["added_stopping_m"],
              1e-8 * best["score"]["latency_p99_ns"].get<double>(), 1e-9);
  EXPECT_NEAR(best["vehicle"]["driving_hours"],
              1000 / (90 + best["score"]["power_w"].get<double>()), 1e-9);
}

/// With the areas that the paper states, both parts of localization do not fit one chip.
TEST_F(Explore, DeclaredAreasDecideWhatFits) {
  const std::string areas =
      temp_.write("areas.json",
                  R"({"frontend": {"lut": 177200, "ff": 82700, "bram36": 785, "dsp": 109},
          "backend": {"lut": 106700, "ff": 111000, "bram36": 509, "dsp": 456}})");
  const std::vector<std::string> pins{"--areas", areas, "--pin", "localization=zcu102"};
  expect_one_line(partita(words("a", pins), kNoOpenCL), 3,
                  {"no placement is feasible", "zcu102", "frontend", "backend"});
  std::vector<std::string> swapping = pins;
  swapping.emplace_back("--allow-swap");
  const json document = explore("b", swapping);
  EXPECT_EQ(document["inputs"]["workload"]["areas_declared"], json::array({"frontend", "backend"}));
  EXPECT_GT(first(document)["best"]["score"]["fpga_area_share"], 1);
}

TEST_F(Explore, AnInterruptedSearchSaysWhatItFound) {
  const Outcome outcome = partita(words("out", {"--frames", "8000"}), kNoOpenCL, [](pid_t child) {
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    kill(child, SIGINT);
  });
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("partial"));
  EXPECT_TRUE(fs::exists(temp_.file("out/PARTIAL")));
  const json document = json::parse(bytes("out", "explore.json"));
  EXPECT_TRUE(document["partial"]);
  EXPECT_FALSE(first(document)["optimal"]);
  EXPECT_LT(first(document)["simulated"], first(document)["placements"]);
}

TEST_F(Explore, ADeviceThatNobodyHasSeen) {
  fs::copy(PARTITA_SOURCE_PROFILES, temp_.file("profiles"), fs::copy_options::recursive);
  std::string device = bytes_of(temp_.file("profiles/devices/gtx1060.yaml"));
  // Four times as many units; everything else as the card that it was copied from.
  const std::size_t units = device.find("units: ");
  ASSERT_NE(units, std::string::npos);
  device.insert(device.find_first_of("0123456789", units), 1, '4');
  temp_.write("profiles/devices/vision-x.yaml", device);
  temp_.write("profiles/machines/tomorrow.yaml",
              "description: PC with a card that nobody has seen\n"
              "nodes:\n  pc:\n    host: i5-8500\n    devices: [gtx1060, vision-x, i5-8500]\n"
              "main_node: pc\nsensor_node: pc\n");
  const json document =
      partita_json(words("out", {"--machine", "tomorrow"}),
                   {{"PARTITA_PROFILES", temp_.file("profiles")}, {"OCL_ICD_VENDORS", "/none"}});
  const json& best = first(document)["best"];
  std::set<std::string> used;
  for (const auto& [task, place] : best["placement"].items()) used.insert(place);
  EXPECT_TRUE(used.contains("vision-x")) << best["placement"];
  const json without = explore("without", {"--machine", "gpu-only"});
  EXPECT_LT(best["score"]["latency_p99_ns"], first(without)["best"]["score"]["latency_p99_ns"]);
  EXPECT_TRUE(document["inputs"]["machines"][0]["profiles"].contains("vision-x"));
  EXPECT_THAT(bytes("out", "schedule.svg"), HasSubstr(">vision-x<"));
}

/// Two tasks on small pictures, so that the run in between is short.
TEST_F(Explore, RunsTheScenarioForTheWorkAndTakesItAgain) {
  std::string small = bytes_of(std::string(PARTITA_SOURCE_PROFILES) + "/pipelines/perception.yaml");
  small.replace(small.find("width: 1280"), 11, "width: 320");
  small.replace(small.find("height: 720"), 11, "height: 180");
  const std::string pipeline = temp_.write("small.yaml", small);
  const Outcome run = partita({"explore", "--pipeline", pipeline, "--out", temp_.file("a")});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, AllOf(HasSubstr("running 30 frames of the built-in scenario on machine "
                                       "dragonfly"),
                             HasSubstr("answered in")));
  EXPECT_THAT(run.out, HasSubstr("30 frames of scenario (seed 1)"));
  partita_json({"explore", "--quiet", "--pipeline", pipeline, "--from", temp_.file("a"), "--out",
                temp_.file("b")},
               kNoOpenCL);
  for (const char* file : kFiles) EXPECT_EQ(bytes("a", file), bytes("b", file)) << file;
  // The pictures are those of the run, whatever the pipeline's file says.
  const json other = partita_json(
      {"explore", "--quiet", "--from", temp_.file("a"), "--out", temp_.file("c")}, kNoOpenCL);
  EXPECT_EQ(other["inputs"]["pipeline"]["width"], 320);
}

}  // namespace
}  // namespace partita::testing
