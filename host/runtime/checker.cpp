#include "host/runtime/checker.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "host/runtime/kernel.h"

namespace partita::runtime {
namespace {

constexpr std::size_t kGuardBytes = 256;
constexpr std::byte kGuard{0xA5};

template <typename T>
void compare_elements(const ArgSpec& arg, const HostArray& got, const HostArray& expected,
                      const Tolerance& tolerance, CheckResult& result) {
  const auto a = got.as<T>();
  const auto b = expected.as<T>();
  for (std::size_t i = 0; i < b.size(); ++i) {
    const double x = static_cast<double>(a[i]);
    const double y = static_cast<double>(b[i]);
    const double error = std::abs(x - y);
    const bool same = a[i] == b[i] || (std::isnan(x) && std::isnan(y)) ||
                      error <= tolerance.absolute + tolerance.relative * std::abs(y);
    ++result.compared;
    if (same) {
      result.largest_error = std::max(result.largest_error, std::isnan(error) ? 0.0 : error);
      continue;
    }
    if (result.different++ == 0) {
      result.first = fmt::format("argument '{}' [{}]: {}, expected {}", arg.name, i, x, y);
    }
    result.equal = false;
    result.largest_error = std::max(result.largest_error, error);
  }
}

void compare(const ArgSpec& arg, const HostArray& got, const HostArray& expected,
             const Tolerance& tolerance, CheckResult& result) {
  switch (arg.type) {
    case ElementType::u8:
      return compare_elements<std::uint8_t>(arg, got, expected, tolerance, result);
    case ElementType::i8:
      return compare_elements<std::int8_t>(arg, got, expected, tolerance, result);
    case ElementType::u16:
      return compare_elements<std::uint16_t>(arg, got, expected, tolerance, result);
    case ElementType::i16:
      return compare_elements<std::int16_t>(arg, got, expected, tolerance, result);
    case ElementType::u32:
      return compare_elements<std::uint32_t>(arg, got, expected, tolerance, result);
    case ElementType::i32:
      return compare_elements<std::int32_t>(arg, got, expected, tolerance, result);
    case ElementType::u64:
      return compare_elements<std::uint64_t>(arg, got, expected, tolerance, result);
    case ElementType::f32:
      return compare_elements<float>(arg, got, expected, tolerance, result);
    case ElementType::f64:
      return compare_elements<double>(arg, got, expected, tolerance, result);
  }
}

bool is_buffer(const ArgSpec& arg) {
  return arg.access != Access::scalar && arg.access != Access::local;
}

/// One device buffer per array argument, each with a guard zone behind it.
std::vector<cl::Buffer> upload(const Session& session, Kernel& kernel, const KernelCase& input) {
  std::vector<cl::Buffer> buffers(input.args.size());
  for (cl_uint i = 0; i < input.args.size(); ++i) {
    const ArgSpec& arg = kernel.spec().args[i];
    const auto bytes = input.args[i].bytes();
    if (arg.access == Access::local) {
      kernel.set_raw(i, bytes.size(), nullptr);
    } else if (arg.access == Access::scalar) {
      kernel.set_raw(i, bytes.size(), bytes.data());
    } else {
      std::vector<std::byte> padded(bytes.begin(), bytes.end());
      padded.resize(bytes.size() + kGuardBytes, kGuard);
      buffers[i] = session.make_buffer(padded.size());
      session.write(buffers[i], padded);
      session.finish();  // `padded` dies here
      const cl_mem memory = buffers[i]();
      kernel.set_raw(i, sizeof memory, &memory);
    }
  }
  return buffers;
}

}  // namespace

CheckResult check_kernel(const Session& session, const KernelSpec& spec, const Shape& shape,
                         std::uint32_t seed) {
  KernelCase expected = spec.make_case(shape, seed);
  Kernel kernel(session, spec);
  const std::vector<cl::Buffer> buffers = upload(session, kernel, expected);
  // The case's own shape: it may have gained counts that the inputs decide.
  kernel.enqueue(expected.shape);
  session.finish();
  spec.golden(expected);

  CheckResult result;
  for (std::size_t i = 0; i < spec.args.size(); ++i) {
    if (!is_buffer(spec.args[i])) continue;
    std::vector<std::byte> padded(expected.args[i].bytes().size() + kGuardBytes);
    session.read(buffers[i], padded);
    HostArray got(spec.args[i].type, expected.args[i].count());
    std::copy_n(padded.begin(), got.bytes().size(), got.bytes().begin());
    compare(spec.args[i], got, expected.args[i], spec.tolerance, result);
    const bool intact = std::all_of(padded.end() - kGuardBytes, padded.end(),
                                    [](std::byte b) { return b == kGuard; });
    if (!intact) {
      result.equal = false;
      if (result.first.empty()) {
        result.first = fmt::format("argument '{}': written behind its end", spec.args[i].name);
      }
    }
  }
  return result;
}

}  // namespace partita::runtime
