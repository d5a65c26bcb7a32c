// `partita diff` and `partita bench simulate`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/spawn.h"
#include "tests/host/io_temp_folder.h"

namespace partita::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// The figure of that name in diff's document.
json figure(const json& document, const std::string& section, const std::string& name) {
  for (const json& item : document["figures"]) {
    if (item["section"] == section && item["figure"] == name) return item;
  }
  ADD_FAILURE() << "no figure " << name;
  return {};
}

TEST(Diff, OfTwoExplorations) {
  const TempFolder temp;
  const auto explore = [&](const std::string& out, const std::string& pin) {
    return partita_json({"explore", "--no-execute", "--quiet", "--machine", "gpu-only", "--pin",
                         pin, "--out", temp.file(out)});
  };
  const json a = explore("a", "depth=gpu"), b = explore("b", "depth=cpu");
  const json document = partita_json({"diff", temp.file("a"), temp.file("b/explore.json")});
  EXPECT_EQ(document["kind"], "exploration");
  EXPECT_EQ(document["inputs"],
            json::array(
                {{{"what", "option pins"}, {"a", R"(["depth=gpu"])"}, {"b", R"(["depth=cpu"])"}}}));
  EXPECT_THAT(
      document["placement"],
      ::testing::Contains(json({{"what", "gpu-only depth"}, {"a", "gtx1060"}, {"b", "i5-8500"}})));
  const json p99 = figure(document, "gpu-only", "latency p99");
  const double x = a["predicted"]["machines"][0]["best"]["score"]["latency_p99_ns"],
               y = b["predicted"]["machines"][0]["best"]["score"]["latency_p99_ns"];
  EXPECT_EQ(p99["a"], x);
  EXPECT_EQ(p99["b"], y);
  EXPECT_NEAR(p99["difference_percent"], 100 * (y - x) / x, 1e-9);

  const Outcome text = partita({"diff", temp.file("a"), temp.file("b")});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("option pins"), HasSubstr("gpu-only depth"),
                              HasSubstr("gpu-only (predicted)"), HasSubstr("B against A")));
  const Outcome same = partita({"diff", temp.file("a"), temp.file("a")});
  EXPECT_THAT(same.out,
              AllOf(HasSubstr("inputs: no difference"), HasSubstr("placement: no difference")));
}

TEST(Diff, OfTwoRuns) {
  const TempFolder temp;
  const auto run = [&](const std::string& out, const std::string& placement) {
    partita_json({"run", "--width", "320", "--height", "180", "--frames", "2", "--quiet",
                  "--placement", placement, "--out", temp.file(out)});
  };
  run("a", "localization=fpga,scene=gpu");
  run("b", "localization=gpu,scene=gpu");
  const json document = partita_json({"diff", temp.file("a"), temp.file("b")});
  EXPECT_EQ(document["kind"], "run");
  EXPECT_EQ(document["inputs"], json::array());
  EXPECT_NE(document["placement"], json::array());
  EXPECT_EQ(figure(document, "accuracy", "ATE")["difference_percent"], 0);
  EXPECT_NE(figure(document, "predicted", "latency localization mean")["difference_percent"], 0);
}

TEST(Bench, SimulatesPlacements) {
  const json document =
      partita_json({"bench", "simulate", "--machine", "tx2", "--rounds", "1", "--frames", "20"});
  const json& row = document["measured"][0];
  EXPECT_EQ(row["machine"], "tx2");
  EXPECT_EQ(row["placements"], 32);
  for (const char* rate : {"every_frame_per_s", "jitter_per_s", "jitter_twice_as_long_per_s",
                           "alike_per_s"}) {
    EXPECT_GT(row[rate], 0) << rate;
  }
  EXPECT_LE(row["placements_apart"], row["placements"]);
  EXPECT_THAT(document["what"].get<std::string>(), HasSubstr("one thread"));
}

}  // namespace
}  // namespace partita::testing
