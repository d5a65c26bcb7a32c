// What a placement has taken, saved and restored: from then on it goes on as if nothing had
// happened, at the same time or any other.
#include <random>

#include <gtest/gtest.h>

#include "devices/timeline/placement.h"

namespace partita::timeline {
namespace {

const std::string kProfiles = PARTITA_SOURCE_DIR "/profiles";

/// Places random commands, all after `from`.
class Commands {
 public:
  Commands(const Layout& layout, std::uint32_t seed) : layout_(layout), random_(seed) {}

  Placed place(Placement& on, Ns from) {
    const auto device = static_cast<DeviceId>(random_() % layout_.devices.size());
    Demand demand;
    demand.launch_ns = random_() % 300;
    demand.compute_ns = 100 + random_() % 5'000;
    demand.memory_ns = random_() % 5'000;
    demand.bytes = random_() % 60'000;
    demand.units = 1 + static_cast<std::uint32_t>(random_() % 8);
    const Ns ready = from + random_() % 20'000;
    switch (random_() % 4) {
      case 0:
        return on.kernel(0, device, 1, "circuit", 2, ready, on.prepare(device, demand));
      case 1:
        return on.inside(0, device, ready, on.prepare_inside(device, demand));
      case 2:
        return on.local_transfer(0, device, random_() % 2 == 0, ready,
                                 on.prepare_transfer(device, demand.bytes));
      default:
        break;
    }
    const std::uint32_t node = layout_.devices[device].node;
    return on.core(0, node, ready, on.prepare_step(node, demand));
  }

 private:
  const Layout& layout_;
  std::mt19937 random_;
};

TEST(Placement, GoesOnAsBeforeFromWhatWasSaved) {
  std::size_t waited = 0;
  for (const std::string& name : profile::list_machines(kProfiles)) {
    const Layout layout = make_layout(profile::load_machine(name, kProfiles));
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      Placement whole(layout, nullptr), later(layout, nullptr);
      Commands before(layout, seed), same(layout, seed);
      Commands after(layout, 100 + seed), again(layout, 100 + seed);
      for (int i = 0; i < 60; ++i) {
        before.place(whole, 0);
        same.place(later, 0);  // circuits are numbered as they come
      }
      const Ns at = 5'000 + 700 * seed, shift = seed % 2 == 0 ? 0 : 1'234'567;
      const Placement::Taken taken = whole.save(at);
      EXPECT_TRUE(taken.all);
      later.restore(taken.words, shift);
      EXPECT_EQ(later.save(shift).words, taken.words);
      EXPECT_EQ(later.save(shift + taken.until).words, std::vector<Ns>{});
      for (int i = 0; i < 60; ++i) {
        const Placed a = after.place(whole, at), b = again.place(later, shift);
        ASSERT_EQ(a.start - at, b.start - shift) << name << " seed " << seed << " command " << i;
        ASSERT_EQ(a.end - at, b.end - shift) << name << " seed " << seed << " command " << i;
        waited += a.end - a.start > 10'000 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(waited, 10u);
}

TEST(Placement, SaysWhenItMayHaveForgotten) {
  const Layout layout = make_layout(profile::load_machine("tx2", kProfiles));
  Placement placement(layout, nullptr);
  Demand demand;
  demand.compute_ns = 10;
  for (Ns i = 0; i < kMaxGaps; ++i) {
    placement.core(0, 0, 100 * i, placement.prepare_step(0, demand));
  }
  EXPECT_FALSE(placement.save(0).all);
}

}  // namespace
}  // namespace partita::timeline
