#include "host/tasks/detection/steps.h"

namespace partita::detection {

using runtime::HostSpec;
using runtime::Shape;

namespace {

// logistic(): a polynomial of degree 7 with its reduction, four Newton steps, by fma.
constexpr std::uint64_t kLogisticFma = 19;

std::uint64_t count(const Shape& shape, const char* name) {
  return static_cast<std::uint64_t>(shape[name]);
}

}  // namespace

const HostSpec& fit_spec() {
  static const HostSpec spec{"fit_picture", "detection", [](const Shape& shape) {
                               // Linear interpolation of three channels along both axes.
                               const std::uint64_t numbers = 3 * count(shape, "pixels");
                               Work work;
                               work.kind = WorkKind::serial;
                               work[OpClass::int_mul] = 4 * numbers;
                               work[OpClass::int_add] = 4 * numbers;
                               work.read_issued = (2 + 8) * numbers;
                               work.read_unique = 2 * numbers;
                               work.written_issued = 8 * numbers;
                               work.written_unique = 4 * numbers;
                               return work;
                             }};
  return spec;
}

const HostSpec& boxes_spec() {
  static const HostSpec spec{"boxes", "detection", [](const Shape& shape) {
                               const std::uint64_t anchors = count(shape, "anchors");
                               const std::uint64_t candidates = count(shape, "candidates");
                               const std::uint64_t compared = count(shape, "compared");
                               const std::uint64_t classes = count(shape, "classes");
                               // Objectness of every anchor; of candidates the best class, four
                               // curves, the box.
                               Work work;
                               work.kind = WorkKind::serial;
                               work[OpClass::float_fma] = kLogisticFma * (anchors + 5 * candidates);
                               work[OpClass::float_add] = anchors + candidates * classes;
                               work[OpClass::double_fma] = 14 * candidates;
                               work[OpClass::double_add] = 8 * compared;
                               work[OpClass::double_special] = compared;
                               work.read_issued =
                                   4 * (anchors + candidates * (4 + classes)) + 32 * compared;
                               work.read_unique = 4 * (anchors + candidates * (4 + classes));
                               work.written_issued = work.written_unique = 40 * candidates;
                               return work;
                             }};
  return spec;
}

std::vector<const HostSpec*> host_specs() {
  return {&fit_spec(), &boxes_spec()};
}

}  // namespace partita::detection
