// Devices: choosing one by kind or name, and what is said when there is none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/runtime/device.h"
#include "host/runtime/error.h"
#include "host/runtime/shape.h"
#include "host/runtime/sources.h"
#include "tests/host/runtime_test_kernels.h"

namespace partita::runtime {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Device named(const std::string& name, cl_device_type type, const std::string& profile = {}) {
  Device device;
  device.name = name;
  device.type = type;
  device.profile = profile;
  return device;
}

const std::vector<Device> kMachine{
    named("xilinx_zcu102_base", CL_DEVICE_TYPE_ACCELERATOR, "zcu102"),
    named("GeForce GTX 1060 6GB", CL_DEVICE_TYPE_GPU, "gtx1060"),
    named("Intel(R) Core(TM) i5-8500 CPU", CL_DEVICE_TYPE_CPU, "i5-8500"),
};

TEST(SelectDevice, ByKindNameOrProfile) {
  EXPECT_EQ(select_device(kMachine, "fpga").profile, "zcu102");
  EXPECT_EQ(select_device(kMachine, "gpu").profile, "gtx1060");
  EXPECT_EQ(select_device(kMachine, "CPU").profile, "i5-8500");
  EXPECT_EQ(select_device(kMachine, "geforce").profile, "gtx1060");
  EXPECT_EQ(select_device(kMachine, "ZCU102").profile, "zcu102");
}

TEST(SelectDevice, NamesWhatThereIs) {
  try {
    select_device(kMachine, "npu");
    FAIL() << "an unknown device was accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("'npu'"), HasSubstr("fpga (xilinx_zcu102_base)"),
                                    HasSubstr("gpu (GeForce"), HasSubstr("cpu (Intel")));
  }
}

TEST(SelectDevice, AShortPartOfANameIsNoChoice) {
  EXPECT_THROW(select_device(kMachine, "e"), Error);
  EXPECT_THROW(select_device(kMachine, "xi"), Error);
  EXPECT_EQ(select_device(kMachine, "xil").profile, "zcu102");
}

TEST(FindDevices, TheRealDeviceIsNotEmulated) {
  const Device device = tests::first_source_device();
  EXPECT_FALSE(device.emulated());
  EXPECT_TRUE(device.node.empty());
  EXPECT_GT(device.max_work_group, 0u);
  EXPECT_GT(device.global_memory, 0u);
}

TEST(ErrorName, KnownAndUnknownCodes) {
  EXPECT_EQ(error_name(CL_OUT_OF_RESOURCES), "CL_OUT_OF_RESOURCES");
  EXPECT_EQ(error_name(-9999), "OpenCL error -9999");
}

TEST(Shape, NamesWhatIsMissingAndWhatIsTooMuch) {
  const Shape shape{{"width", 64}, {"height", 48}};
  EXPECT_EQ(shape["height"], 48);
  EXPECT_EQ(shape.with("width", 32)["width"], 32);
  EXPECT_EQ(shape.to_string(), "width=64 height=48");
  EXPECT_THROW(shape["depth"], Error);
  static constexpr const char* kNames[] = {"a", "b", "c", "d", "e", "f",
                                           "g", "h", "i", "j", "k", "l"};
  Shape full;
  for (const char* name : kNames) full = full.with(name, 1);
  EXPECT_THROW(full.with("one too many", 1), Error);
}

TEST(Variants, ReadOnlyTheirNames) {
  for (const Variant variant : kVariants) EXPECT_EQ(parse_variant(to_string(variant)), variant);
  EXPECT_THROW(parse_variant("npu"), Error);
}

TEST(Sources, AFileThatIsNotThereIsNamed) {
  EXPECT_THAT(flattened_source("bench/tiny.cl"), HasSubstr("void tiny("));
  EXPECT_THROW(flattened_source("bench/missing.cl"), Error);
  KernelSpec spec = tests::adding_spec();
  spec.source = "missing";
  EXPECT_THROW(kernel_file(spec, Variant::gpu), Error);
}

}  // namespace
}  // namespace partita::runtime
