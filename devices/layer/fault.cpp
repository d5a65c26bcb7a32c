#include "devices/layer/fault.h"

#include <charconv>
#include <string_view>

namespace partita::layer {
namespace {

[[noreturn]] void fail(std::string_view part, const char* expected) {
  throw std::invalid_argument("PARTITA_FAULT: '" + std::string(part) + "': expected " + expected);
}

std::uint64_t read_count(std::string_view digits, std::string_view part) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || error != std::errc() || end != digits.data() + digits.size() ||
      value == 0 || value > 1'000'000'000) {
    fail(part, "a whole number from 1 to 1000000000");
  }
  return value;
}

bool take_prefix(std::string_view& text, std::string_view prefix) {
  if (text.substr(0, prefix.size()) != prefix) return false;
  text.remove_prefix(prefix.size());
  return true;
}

Fault parse_one(std::string_view part) {
  std::string_view text = part;
  Fault fault;
  const std::size_t colon = text.find(':');
  if (!take_prefix(text, "device=") || colon == std::string_view::npos || colon <= 7) {
    fail(part, "device=NAME:FAULT");
  }
  fault.device = part.substr(7, colon - 7);
  text = part.substr(colon + 1);
  if (text == "build-fail") {
    fault.kind = FaultKind::build_fail;
  } else if (take_prefix(text, "lost@")) {
    fault.kind = FaultKind::lost;
    fault.at = read_count(text, part);
  } else if (take_prefix(text, "out-of-memory@")) {
    fault.kind = FaultKind::out_of_memory;
    fault.at = read_count(text, part);
  } else if (take_prefix(text, "stall@")) {
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) fail(part, "stall@N=MILLISECONDS");
    fault.kind = FaultKind::stall;
    fault.at = read_count(text.substr(0, equals), part);
    fault.stall_ns = read_count(text.substr(equals + 1), part) * 1'000'000;
  } else {
    fail(part, "lost@N, build-fail, out-of-memory@N or stall@N=MILLISECONDS");
  }
  return fault;
}

}  // namespace

std::vector<Fault> parse_faults(const std::string& text) {
  std::vector<Fault> faults;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = rest.find(',');
    faults.push_back(parse_one(rest.substr(0, end)));
    if (end == std::string_view::npos) break;
    rest.remove_prefix(end + 1);
    if (rest.empty()) fail(text, "a fault after ','");
  }
  return faults;
}

cl_int FaultState::next_command(std::uint64_t& stall_ns) {
  stall_ns = 0;
  if (faults_.empty()) return CL_SUCCESS;
  const std::uint64_t n = ++commands_;
  for (const Fault& f : faults_) {
    if (f.kind == FaultKind::lost && n >= f.at) lost_ = true;
    if (f.kind == FaultKind::stall && n == f.at) stall_ns += f.stall_ns;
  }
  return lost_ ? CL_OUT_OF_RESOURCES : CL_SUCCESS;
}

cl_int FaultState::next_allocation() {
  if (faults_.empty()) return CL_SUCCESS;
  const std::uint64_t n = ++allocations_;
  if (lost_) return CL_OUT_OF_RESOURCES;
  for (const Fault& f : faults_) {
    if (f.kind == FaultKind::out_of_memory && n == f.at) return CL_MEM_OBJECT_ALLOCATION_FAILURE;
  }
  return CL_SUCCESS;
}

bool FaultState::build_fails() const {
  for (const Fault& f : faults_) {
    if (f.kind == FaultKind::build_fail) return true;
  }
  return false;
}

}  // namespace partita::layer
