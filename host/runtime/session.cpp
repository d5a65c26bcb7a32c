#include "host/runtime/session.h"

#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/runtime/program.h"
#include "host/runtime/sources.h"

namespace partita::runtime {
namespace {

/// The portable floor: every runtime that we know takes this.
constexpr const char* kBaseOptions = "-cl-std=CL1.2";

std::string options_of(const KernelSpec& spec) {
  return spec.options.empty() ? kBaseOptions : fmt::format("{} {}", kBaseOptions, spec.options);
}

[[noreturn]] void fail(const Device& device, const char* what, const cl::Error& error) {
  throw DeviceError(fmt::format("{}: {} failed ({})", device.name, what, error_name(error.err())));
}

}  // namespace

std::string_view to_string(Execute execute) {
  return execute == Execute::own ? "own" : "fast";
}

Session::Session(const Device& device, Specs specs, SessionOptions options)
    : device_(device),
      extension_(device.platform),
      specs_(std::move(specs)),
      options_(std::move(options)),
      charged_(options_.variant.value_or(device.own_variant())),
      executed_(options_.execute == Execute::fast ? Variant::cpu : charged_) {
  try {
    context_ = cl::Context(device_.cl);
    queue_ = cl::CommandQueue(context_, device_.cl, CL_QUEUE_PROFILING_ENABLE);
  } catch (const cl::Error& error) {
    fail(device_, "opening the device", error);
  }
  if (options_.cache_folder.empty()) options_.cache_folder = user_cache_folder();
  if (!device_.accepts_source) {
    load_container(options_.container);
    return;
  }
  for (const KernelSpec* spec : specs_) load_from_source(*spec);
}

void Session::load_container(const std::string& path) {
  if (path.empty()) {
    throw Error(
        fmt::format("{}: takes kernels only from a container, and none was named", device_.name));
  }
  programs_["container"] = {build_from_container(context_, device_, path), {}, true};
}

void Session::load_from_source(const KernelSpec& spec) {
  if (!spec.has(executed_)) {
    throw Error(fmt::format("kernel {} has no {} variant, which {} needs", spec.name,
                            to_string(executed_), device_.name));
  }
  const std::string file(kernel_file(spec, executed_));
  const std::string options = options_of(spec);
  const std::string key = file + " " + options;
  if (programs_.contains(key)) return;

  const std::string text = flattened_source(file);
  Entry entry;
  if (!options_.cache_folder.empty() && options_.cache_folder != "-") {
    entry.cache_path = cache_path(options_.cache_folder, device_, options, text);
    if (auto program = build_from_cache(context_, device_, entry.cache_path, options)) {
      entry.program = *program;
      entry.restored = true;
    }
  }
  if (!entry.restored) {
    entry.program = build_from_source(context_, device_, "kernels/" + file, text, options);
  }
  programs_[key] = std::move(entry);
}

const Session::Entry& Session::entry_for(const KernelSpec& spec) const {
  std::string key = "container";
  if (device_.accepts_source) {
    key = fmt::format("{} {}", kernel_file(spec, executed_), options_of(spec));
  }
  const auto found = programs_.find(key);
  if (found == programs_.end()) {
    throw Error(fmt::format("kernel {} was not loaded on {}", spec.name, device_.name));
  }
  return found->second;
}

cl::Kernel Session::make_kernel(const KernelSpec& spec) const {
  try {
    return cl::Kernel(entry_for(spec).program, spec.name.c_str());
  } catch (const cl::Error& error) {
    throw DeviceError(fmt::format("kernel {}: not in the program loaded on {} ({})", spec.name,
                                  device_.name, error_name(error.err())));
  }
}

cl::Buffer Session::make_buffer(std::size_t bytes, cl_mem_flags flags) const {
  try {
    return cl::Buffer(context_, flags, bytes);
  } catch (const cl::Error& error) {
    throw DeviceError(fmt::format("{}: a buffer of {} bytes cannot be had ({})", device_.name,
                                  bytes, error_name(error.err())));
  }
}

void Session::write(const cl::Buffer& buffer, std::span<const std::byte> bytes) const {
  try {
    queue_.enqueueWriteBuffer(buffer, CL_FALSE, 0, bytes.size(), bytes.data());
  } catch (const cl::Error& error) {
    fail(device_, "writing a buffer", error);
  }
}

void Session::read(const cl::Buffer& buffer, std::span<std::byte> bytes) const {
  try {
    queue_.enqueueReadBuffer(buffer, CL_TRUE, 0, bytes.size(), bytes.data());
  } catch (const cl::Error& error) {
    fail(device_, "reading a buffer", error);
  }
}

void Session::finish() const {
  try {
    queue_.finish();
  } catch (const cl::Error& error) {
    fail(device_, "finishing the queue", error);
  }
}

void Session::save_binaries() const {
  for (const auto& [key, entry] : programs_) {
    if (!entry.restored && !entry.cache_path.empty()) save_binary(entry.program, entry.cache_path);
  }
}

}  // namespace partita::runtime
