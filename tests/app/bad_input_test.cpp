// Bad input: one clear line on stderr, a status of its own, and nothing half-written that looks
// whole.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sys/mount.h>
#include <sys/resource.h>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/spawn.h"
#include "tests/host/io_temp_folder.h"

namespace partita::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A sequence of three small frames on disk, made once and copied for each way of breaking it.
class BadInput : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    const Outcome made = partita({"generate", "--out", folder_->file("good"), "--frames", "3",
                                  "--width", "320", "--height", "180", "--quiet"});
    ASSERT_EQ(made.status, 0) << made.err;
  }
  static void TearDownTestSuite() { delete folder_; }

  std::string copy_of_good() const {
    fs::copy(folder_->file("good"), temp_.file("data"), fs::copy_options::recursive);
    return temp_.file("data");
  }
  std::string out() const { return temp_.file("out"); }
  Outcome run(std::vector<std::string> more, const Environment& environment = {}) const {
    std::vector<std::string> words{"run", "--machine", "native", "--quiet", "--out", out()};
    words.insert(words.end(), more.begin(), more.end());
    return partita(words, environment);
  }
  /// The output folder is absent, or says that it is not whole.
  void expect_nothing_whole() const {
    EXPECT_TRUE(!fs::exists(out()) || fs::exists(out() + "/PARTIAL"));
    if (fs::exists(out() + "/summary.json")) {
      EXPECT_TRUE(nlohmann::json::parse(bytes_of(out() + "/summary.json"))["partial"]);
    }
  }

  static inline TempFolder* folder_ = nullptr;
  TempFolder temp_;
};

void truncate_to_half(const std::string& path) {
  fs::resize_file(path, fs::file_size(path) / 2);
}

void replace_in(const std::string& path, const std::string& what, const std::string& with) {
  const std::string text = std::regex_replace(bytes_of(path), std::regex(what), with,
                                              std::regex_constants::format_first_only);
  ASSERT_NE(text, bytes_of(path)) << what << " is not in " << path;
  std::ofstream(path, std::ios::binary) << text;
}

TEST_F(BadInput, ADataSetThatIsMissing) {
  expect_one_line(run({"--dataset", temp_.file("nowhere")}), 3, {"nowhere"});
  expect_nothing_whole();
}

TEST_F(BadInput, AnImageThatIsMissing) {
  const std::string data = copy_of_good();
  fs::remove(data + "/image_1/000001.png");
  expect_one_line(run({"--dataset", data}), 3, {"image_1"});
  expect_nothing_whole();
}

TEST_F(BadInput, ATruncatedImageEndsTheRunAndKeepsWhatWasFinished) {
  const std::string data = copy_of_good();
  truncate_to_half(data + "/image_0/000002.png");
  expect_one_line(run({"--dataset", data}), 3, {"image_0/000002.png", "truncated"});
  expect_nothing_whole();
  EXPECT_TRUE(fs::exists(out() + "/disparity/000000.png"));
  EXPECT_FALSE(fs::exists(out() + "/disparity/000002.png"));
  const auto summary = nlohmann::json::parse(bytes_of(out() + "/summary.json"));
  EXPECT_EQ(summary["input"]["frames"], 2);
}

TEST_F(BadInput, ImagesOfDifferentSize) {
  const std::string data = copy_of_good();
  TempFolder other;
  ASSERT_EQ(partita({"generate", "--out", other.file("d"), "--frames", "1", "--width", "256",
                     "--height", "180", "--quiet"})
                .status,
            0);
  fs::copy_file(other.file("d/image_1/000000.png"), data + "/image_1/000001.png",
                fs::copy_options::overwrite_existing);
  expect_one_line(run({"--dataset", data}), 3, {"image_1/000001.png", "256"});
  expect_nothing_whole();
}

TEST_F(BadInput, ACalibrationThatDoesNotParse) {
  const std::string data = copy_of_good();
  std::ofstream(data + "/calib.txt") << "P0: 1 2 three\n";
  expect_one_line(run({"--dataset", data}), 3, {"calib.txt:1"});
  expect_nothing_whole();
}

class BadProfile : public BadInput {
 protected:
  void SetUp() override {
    fs::copy(PARTITA_SOURCE_PROFILES, temp_.file("profiles"), fs::copy_options::recursive);
  }
  Outcome run_dragonfly() const {
    return partita({"run", "--frames", "1", "--quiet", "--out", out()},
                   {{"PARTITA_PROFILES", temp_.file("profiles")}});
  }
  std::string gtx1060() const { return temp_.file("profiles/devices/gtx1060.yaml"); }
};

TEST_F(BadProfile, AnUnknownKey) {
  std::ofstream(gtx1060(), std::ios::app) << "\nturbo: true\n";
  expect_one_line(run_dragonfly(), 3, {"gtx1060.yaml:", "turbo"});
}

TEST_F(BadProfile, ANegativeNumber) {
  replace_in(gtx1060(), "value: ", "value: -");
  expect_one_line(run_dragonfly(), 3, {"gtx1060.yaml:", "-"});
}

TEST_F(BadProfile, AMachineThatDoesNotExist) {
  expect_one_line(partita({"devices", "--machine", "firefly"}), 3, {"firefly", "dragonfly"});
  expect_one_line(partita({"devices", "--machine", "/nowhere/m.yaml"}), 3, {"/nowhere/m.yaml"});
}

TEST_F(BadInput, APlacementOnNoSuchDeviceOrTask) {
  expect_one_line(run({"--placement", "scene=npu"}), 3, {"npu", "cpu"});
  expect_one_line(run({"--placement", "localisation=cpu"}), 2, {"'localisation'", "localization"});
  expect_one_line(run({"--placement", "scene"}), 2, {"'scene'"});
  expect_one_line(run({"--placement", "scene=p"}), 3, {"'p'", "cpu"});
  expect_one_line(partita({"run", "--quiet", "--machine", "gpu-only", "--placement",
                           "localization=fpga", "--out", out()}),
                  3, {"fpga", "gpu"});
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(BadInput, NoOpenclPlatformAtAll) {
  const Environment none{{"OCL_ICD_VENDORS", "/nonexistent"}};
  expect_one_line(run({"--frames", "1"}, none), 4, {"no OpenCL platform"});
  expect_one_line(partita({"run", "--frames", "1", "--quiet", "--out", out()}, none), 4,
                  {"OpenCL"});
  expect_one_line(partita({"verify", "--machine", "native"}, none), 4, {"no OpenCL platform"});
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(BadInput, AnOutputFolderThatCannotBeWritten) {
  std::ofstream(out()) << "a file, not a folder";
  expect_one_line(run({"--dataset", folder_->file("good")}), 5, {out()});
  EXPECT_EQ(bytes_of(out()), "a file, not a folder");
  expect_one_line(
      partita({"run", "--machine", "native", "--frames", "1", "--quiet", "--out", "/proc/partita"}),
      5, {"/proc/partita"});
  expect_one_line(partita({"generate", "--frames", "1", "--quiet", "--out", "/proc/partita"}), 5,
                  {"/proc/partita"});
}

TEST_F(BadInput, SomebodyElsesFilesAreLeftAlone) {
  fs::create_directory(out());
  std::ofstream(out() + "/thesis.txt") << "years of work";
  expect_one_line(run({"--dataset", folder_->file("good")}), 5, {"--force"});
  expect_one_line(partita({"generate", "--out", out(), "--quiet"}), 5, {"--force"});
  EXPECT_EQ(std::distance(fs::directory_iterator(out()), {}), 1);
}

TEST_F(BadInput, ForceReplacesNothingThatNoRunWrote) {
  const std::vector<std::string> force{"--dataset", folder_->file("good"), "--force"};
  fs::create_directories(out() + "/disparity");
  std::ofstream(out() + "/thesis.txt") << "years of work";
  for (const std::string name :
       {"disparity/my_truth.png", "disparity/000123.png", "trajectory.txt", "PARTIAL"}) {
    std::ofstream(out() + "/" + name) << "mine";
    expect_one_line(run(force), 5, {out() + "/" + name.substr(0, name.find('/')), "--force"});
    EXPECT_EQ(bytes_of(out() + "/" + name), "mine");
    fs::remove(out() + "/" + name);
  }
  EXPECT_EQ(run(force).status, 0);
  EXPECT_EQ(bytes_of(out() + "/thesis.txt"), "years of work");
}

TEST_F(BadInput, TheDataSetIsNoOutputFolder) {
  const std::string data = copy_of_good();
  const std::string truth = bytes_of(data + "/disparity/000000.png");
  fs::create_directory(temp_.file("linked"));
  for (const auto& entry : fs::directory_iterator(data)) {
    fs::create_symlink(entry.path(), fs::path(temp_.file("linked")) / entry.path().filename());
  }
  for (const auto& [dataset, folder] :
       std::vector<std::pair<std::string, std::string>>{{data, data},
                                                        {data + "/", data + "/../data"},
                                                        {data, data + "/image_0"},
                                                        {data, data + "/results"},
                                                        {temp_.file("linked"), data}}) {
    expect_one_line(partita({"run", "--machine", "native", "--quiet", "--force", "--dataset",
                             dataset, "--out", folder}),
                    5, {folder, "data set"});
  }
  EXPECT_EQ(bytes_of(data + "/disparity/000000.png"), truth);
  EXPECT_FALSE(fs::exists(data + "/summary.json"));
}

TEST_F(BadInput, NumbersOutOfRangeAreUsageErrors) {
  for (const std::string command : {"run", "generate"}) {
    for (const auto& [option, value] : std::vector<std::pair<std::string, std::string>>{
             {"--seed", "-1"}, {"--seed", "18446744073709551616"}, {"--rate", "nan"}}) {
      const Outcome outcome = partita({command, "--out", out(), option, value});
      EXPECT_EQ(outcome.status, 2) << command << ' ' << option << ' ' << value;
      EXPECT_THAT(outcome.err, HasSubstr(option));
    }
  }
  EXPECT_FALSE(fs::exists(out()));
}

/// Lets no file grow beyond `bytes`, as a full disk would, for this process's children.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_F(BadInput, ADiskThatFills) {
  // A small file system of its own where that is permitted, else a limit on every file's size.
  fs::create_directory(out());
  if (mount("none", out().c_str(), "tmpfs", 0, "size=64k") == 0) {
    expect_one_line(run({"--dataset", folder_->file("good")}), 5, {out()});
    expect_nothing_whole();
    EXPECT_EQ(umount(out().c_str()), 0);
  }
  fs::remove_all(out());
  // Caches are written elsewhere, and a cache that cannot be written is no error: fill them first.
  ASSERT_EQ(run({"--dataset", folder_->file("good")}).status, 0);
  fs::remove_all(out());
  const FileSizeLimit limit(8192);
  expect_one_line(run({"--dataset", folder_->file("good")}), 5, {out()});
  expect_nothing_whole();
}

TEST_F(BadInput, CtrlCFinishesTheFrameAndMarksTheRestAsMissing) {
  const auto interrupt_after_two_frames = [this](pid_t child) {
    for (int i = 0; i < 6000 && !fs::exists(out() + "/disparity/000001.png"); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    kill(child, SIGINT);
  };
  const Outcome outcome = partita({"run", "--machine", "native", "--frames", "3000", "--width",
                                   "320", "--height", "180", "--out", out(), "--quiet"},
                                  {}, interrupt_after_two_frames);
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  expect_nothing_whole();
  const auto summary = nlohmann::json::parse(bytes_of(out() + "/summary.json"));
  EXPECT_TRUE(summary["partial"]);
  const std::size_t frames = summary["input"]["frames"];
  EXPECT_GE(frames, 2u);
  EXPECT_LT(frames, 3000u);
  const std::string trajectory = bytes_of(out() + "/trajectory.txt");
  EXPECT_EQ(std::count(trajectory.begin(), trajectory.end(), '\n'), frames);
  EXPECT_EQ(std::distance(fs::directory_iterator(out() + "/disparity"), {}), frames);
}

TEST_F(BadInput, CtrlCWhileGeneratingLeavesItMarked) {
  const std::string target = temp_.file("street");
  const Outcome outcome =
      partita({"generate", "--frames", "3000", "--width", "320", "--height", "180", "--out", target,
               "--quiet"},
              {}, [&](pid_t child) {
                for (int i = 0; i < 6000 && !fs::exists(target + "/image_1/000001.png"); ++i) {
                  std::this_thread::sleep_for(std::chrono::milliseconds(10));
                }
                kill(child, SIGINT);
              });
  expect_one_line(outcome, 130, {"interrupted"});
  EXPECT_TRUE(fs::exists(target + "/PARTIAL"));
  expect_one_line(partita({"run", "--machine", "native", "--quiet", "--out", target}), 5,
                  {target, "no earlier run"});
}

}  // namespace
}  // namespace partita::testing
