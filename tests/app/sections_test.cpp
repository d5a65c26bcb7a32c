// Several kernel files in one container: their names must not meet.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/model/area.h"
#include "host/app/packager.h"
#include "host/app/text_sections.h"
#include "host/runtime/error.h"
#include "host/runtime/program.h"
#include "host/tasks/backend/kernels.h"
#include "host/tasks/registry.h"

namespace partita::app {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kFile = R"cl(// A comment with brackets ( { and a word helper(
#ifndef GUARD_CLH
#define GUARD_CLH
#define SQUARE(x) \
  ((x) * (x))
#endif
typedef struct { int a; } Pair;
struct Named { int b; };
__constant short kTable[2] = {1, 2};
static inline int helper(int x, __global const int* p) { return SQUARE(x) + p[0] + helper2(x); }
uint __attribute__((always_inline)) attributed(void) { return 1u; }
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void add(__global int* out) { out[0] = '}'; }
)cl";

TEST(TopLevelNames, HelpersTypesConstantsAndMacros) {
  const TopLevelNames names = top_level_names(kFile);
  EXPECT_THAT(names.declared, ElementsAre("Named", "Pair", "attributed", "helper", "kTable"));
  EXPECT_THAT(names.macros, ElementsAre("GUARD_CLH", "SQUARE"));
}

TEST(JoinSections, EachHasItsOwnHelpersMacrosAndOptions) {
  const std::string helper = "static int value(void) { return RADIUS * FACTOR; }\n";
  const std::string joined = join_sections(
      {{"a.cl",
        "#define FACTOR 2\n" + helper + "__kernel void a(__global int* o) { o[0] = value(); }\n",
        "-DRADIUS=3"},
       {"b.cl",
        "#define FACTOR 5\n" + helper + "__kernel void b(__global int* o) { o[0] = value(); }\n",
        "-DRADIUS=7 -DFLAG"}});
  const runtime::Device device = runtime::find_devices().front();
  const cl::Context context(device.cl);
  const cl::CommandQueue queue(context, device.cl);
  const cl::Program program =
      runtime::build_from_source(context, device, "joined", joined, "-cl-std=CL1.2 -Werror");
  cl::Buffer out(context, CL_MEM_READ_WRITE, sizeof(cl_int));
  for (const auto& [name, expected] : {std::pair{"a", 6}, std::pair{"b", 35}}) {
    cl::Kernel kernel(program, name);
    kernel.setArg(0, out);
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1));
    cl_int value = 0;
    queue.enqueueReadBuffer(out, CL_TRUE, 0, sizeof value, &value);
    EXPECT_EQ(value, expected) << name;
  }
}

TEST(JoinSections, RefusesOptionsThatCannotBeText) {
  EXPECT_THROW(join_sections({{"a.cl", "", "-cl-fast-relaxed-math"}}), Error);
}

class Containers : public ::testing::TestWithParam<runtime::Execute> {
 protected:
  profile::DeviceProfile device_ =
      profile::load_device(PARTITA_SOURCE_PROFILES "/devices/zcu102.yaml");
};

void expect_whole(const layer::Container& container, const profile::DeviceProfile& profile,
                  const std::vector<const runtime::KernelSpec*>& kernels) {
  EXPECT_EQ(model::misfit(container.area, profile), "");
  EXPECT_EQ(container.device, "zcu102");
  const runtime::Device device = runtime::find_devices().front();
  const cl::Program program = runtime::build_from_source(
      cl::Context(device.cl), device, "container", container.text, container.build_options);
  for (const runtime::KernelSpec* spec : kernels) {
    const layer::ContainerKernel* kernel = container.find(spec->name);
    ASSERT_NE(kernel, nullptr) << spec->name;
    EXPECT_EQ(kernel->args.size(), spec->args.size());
    EXPECT_FALSE(kernel->loops.empty()) << spec->name << " declares no loop";
    EXPECT_NO_THROW(cl::Kernel(program, spec->name.c_str())) << spec->name;
  }
}

TEST_P(Containers, HoldEveryFpgaKernelOfTheVehicleCompilableAndFitting) {
  const layer::Container container = make_container(device_, {.tasks = {}, .model = GetParam()});
  expect_whole(container, device_, tasks::vehicle_kernels());
}

TEST_P(Containers, OfTheBackEndFitByThemselves) {
  for (const auto camera : {backend::CameraModel::bal, backend::CameraModel::stereo}) {
    const auto kernels = backend::kernels(camera, backend::Precision::single).list();
    const layer::Container container =
        make_container(device_, {.kernels = kernels, .model = GetParam()});
    EXPECT_EQ(container.kernels.size(), kernels.size());
    expect_whole(container, device_, kernels);
  }
}

TEST_P(Containers, AreTheSameBytesEachTime) {
  const PackageOptions options{.tasks = {"frontend"}, .model = GetParam()};
  EXPECT_EQ(layer::serialize(make_container(device_, options)),
            layer::serialize(make_container(device_, options)));
}

INSTANTIATE_TEST_SUITE_P(Models, Containers,
                         ::testing::Values(runtime::Execute::own, runtime::Execute::fast),
                         [](const auto& model) { return std::string(to_string(model.param)); });

TEST(Packager, RefusesUnknownTasksAndOtherDevices) {
  const auto zcu102 = profile::load_device(PARTITA_SOURCE_PROFILES "/devices/zcu102.yaml");
  const auto gpu = profile::load_device(PARTITA_SOURCE_PROFILES "/devices/gtx1060.yaml");
  EXPECT_THROW(make_container(zcu102, {.tasks = {"planing"}}), Error);
  EXPECT_THROW(make_container(gpu, {}), Error);
}

}  // namespace
}  // namespace partita::app
