// The program loader: source, cached binaries, containers, and what it says when they are bad.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/runtime/checker.h"
#include "host/runtime/error.h"
#include "host/runtime/kernel.h"
#include "host/runtime/program.h"
#include "tests/host/io_temp_folder.h"
#include "tests/host/runtime_test_kernels.h"

namespace partita::runtime {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

class ProgramTest : public ::testing::Test {
 protected:
  std::string folder() const { return temp_.path(); }
  std::vector<fs::path> cached() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder())) files.push_back(entry.path());
    return files;
  }
  CheckResult check() const {
    const Session session(device_, {&spec_}, {.cache_folder = folder()});
    const CheckResult result = check_kernel(session, spec_, {{"items", 1}}, 41);
    session.save_binaries();
    return result;
  }

  partita::testing::TempFolder temp_;
  Device device_ = tests::first_source_device();
  KernelSpec spec_ = tests::adding_spec();
};

TEST_F(ProgramTest, CachesABinaryAndRestoresIt) {
  EXPECT_TRUE(check().equal);
  ASSERT_EQ(cached().size(), 1u);
  const auto written = fs::last_write_time(cached()[0]);
  EXPECT_TRUE(check().equal);
  ASSERT_EQ(cached().size(), 1u);
  EXPECT_EQ(fs::last_write_time(cached()[0]), written) << "a restored binary was written again";
}

TEST_F(ProgramTest, BuildsFromSourceWhenTheCachedBinaryIsDamaged) {
  EXPECT_TRUE(check().equal);
  ASSERT_EQ(cached().size(), 1u);
  for (const char* damage : {"", "no binary at all"}) {
    std::ofstream(cached()[0], std::ios::binary) << damage;
    EXPECT_TRUE(check().equal) << "damage: '" << damage << "'";
  }
}

TEST_F(ProgramTest, OtherOptionsTextOrDeviceAreOtherFiles) {
  const std::string path = cache_path(folder(), device_, "-O", "text");
  EXPECT_EQ(path, cache_path(folder(), device_, "-O", "text"));
  EXPECT_NE(path, cache_path(folder(), device_, "-O0", "text"));
  EXPECT_NE(path, cache_path(folder(), device_, "-O", "text2"));
  EXPECT_NE(path, cache_path(folder(), device_, "-", "O|text"));
  Device other = device_;
  other.driver_version += ".1";
  EXPECT_NE(path, cache_path(folder(), other, "-O", "text"));
}

TEST_F(ProgramTest, ACacheThatCannotBeWrittenIsNoError) {
  const Session session(device_, {&spec_},
                        {.cache_folder = folder() + "/missing"});
  EXPECT_NO_THROW(session.save_binaries());
}

template <typename Exception, typename Function>
std::string message_of(Function&& function) {
  try {
    function();
  } catch (const Exception& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST_F(ProgramTest, ABuildThatFailsNamesFileDeviceAndComplaint) {
  const cl::Context context(device_.cl);
  const std::string message = message_of<DeviceError>([&] {
    build_from_source(context, device_, "kernels/x.cl", "__kernel void k() { undefined_thing; }",
                      "");
  });
  EXPECT_THAT(message, HasSubstr("kernels/x.cl"));
  EXPECT_THAT(message, HasSubstr(device_.name));
  EXPECT_THAT(message, HasSubstr("undefined_thing"));
  EXPECT_THAT(message, Not(HasSubstr("\n")));
}

TEST_F(ProgramTest, AContainerThatIsMissingOrNoContainerIsTold) {
  const cl::Context context(device_.cl);
  EXPECT_THAT(
      message_of<Error>([&] { build_from_container(context, device_, folder() + "/none"); }),
      HasSubstr("/none: cannot be read"));
  const std::string path = folder() + "/garbage";
  std::ofstream(path) << "garbage";
  EXPECT_THAT(message_of<DeviceError>([&] { build_from_container(context, device_, path); }),
              HasSubstr("garbage"));
}

TEST_F(ProgramTest, ASessionRefusesVariantsAndKernelsThatItLacks) {
  EXPECT_THAT(message_of<Error>([&] { Session(device_, {&spec_}, {.variant = Variant::fpga}); }),
              HasSubstr("kernel tiny has no fpga variant"));
  const Session session(device_, {}, {.cache_folder = "-"});
  EXPECT_THAT(message_of<Error>([&] { session.make_kernel(spec_); }),
              HasSubstr("kernel tiny was not loaded"));
}

TEST_F(ProgramTest, LaunchesCheckTheirArguments) {
  const Session session(device_, {&spec_}, {.cache_folder = "-"});
  Kernel kernel(session, spec_);
  const cl::Buffer buffer = session.make_buffer(4);
  EXPECT_THAT(message_of<Error>([&] {
                kernel.launch({{"items", 1}}, buffer, 1);
              }),
              HasSubstr("takes 1 arguments, 2 were given"));
  EXPECT_THAT(message_of<Error>([&] {
                kernel.launch({{"items", 1}}, 1);
              }),
              HasSubstr("argument 0 'count' is a uint array"));
}

TEST_F(ProgramTest, AKernelThatIsWrongIsFound) {
  KernelSpec wrong = spec_;
  wrong.golden = [](KernelCase& c) { c.args[0].as<std::uint32_t>()[0] += 2; };
  const Session session(device_, {&wrong}, {.cache_folder = "-"});
  const CheckResult result = check_kernel(session, wrong, {{"items", 1}}, 41);
  EXPECT_FALSE(result.equal);
  EXPECT_EQ(result.different, 1u);
  EXPECT_EQ(result.largest_error, 1.0);
  EXPECT_THAT(result.first, HasSubstr("argument 'count' [0]: 42, expected 43"));
}

}  // namespace
}  // namespace partita::runtime
