#include "host/runtime/program.h"

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::runtime {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<unsigned char>;

/// FNV-1a, 64 bit: names cache files; a collision would need 2^32 programs.
std::uint64_t hash(std::string_view text, std::uint64_t state = 0xcbf29ce484222325ULL) {
  for (const char c : text) state = (state ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return state;
}

std::optional<Bytes> read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return Bytes(std::istreambuf_iterator<char>(file), {});
}

/// The first line that says "error", or the first line at all.
std::string first_complaint(const std::string& log) {
  std::string first;
  std::size_t begin = 0;
  while (begin < log.size()) {
    const std::size_t end = std::min(log.find('\n', begin), log.size());
    const std::string line = log.substr(begin, end - begin);
    if (line.find("error") != std::string::npos) return line;
    if (first.empty()) first = line;
    begin = end + 1;
  }
  return first.empty() ? "no build log" : first;
}

void build(const cl::Program& program, const Device& device, const std::string& name,
           const std::string& options) {
  // The C API, because the C++ binding's exception would drop the log on some versions.
  const cl_device_id id = device.cl();
  const cl_int code = clBuildProgram(program(), 1, &id, options.c_str(), nullptr, nullptr);
  if (code == CL_SUCCESS) return;
  std::string log;
  program.getBuildInfo(device.cl, CL_PROGRAM_BUILD_LOG, &log);
  throw DeviceError(fmt::format("{}: does not build for {}: {} ({})", name, device.name,
                                first_complaint(log), error_name(code)));
}

}  // namespace

std::string user_cache_folder() {
  fs::path base;
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg != nullptr && *xdg != '\0') {
    base = xdg;
  } else if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') {
    base = fs::path(home) / ".cache";
  } else {
    return {};
  }
  std::error_code code;
  fs::create_directories(base / "partita", code);
  return code ? std::string() : (base / "partita").string();
}

std::string cache_path(const std::string& folder, const Device& device, const std::string& options,
                       const std::string& text) {
  std::uint64_t key = hash(device.platform_name);
  for (const std::string& part : {device.name, device.driver_version, options, text}) {
    key = hash(part, hash("|", key));
  }
  return fmt::format("{}/{:016x}.bin", folder, key);
}

cl::Program build_from_source(const cl::Context& context, const Device& device,
                              const std::string& name, const std::string& text,
                              const std::string& options) {
  cl::Program program(context, text);
  build(program, device, name, options);
  return program;
}

std::optional<cl::Program> build_from_cache(const cl::Context& context, const Device& device,
                                            const std::string& path, const std::string& options) {
  const auto bytes = read_file(path);
  if (!bytes || bytes->empty()) return std::nullopt;
  try {
    cl::Program program(context, {device.cl}, {*bytes});
    build(program, device, path, options);
    return program;
  } catch (const cl::Error&) {
    return std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

void save_binary(const cl::Program& program, const std::string& path) {
  const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
  if (binaries.empty() || binaries.front().empty()) return;
  // Beside the target and then renamed: another process never sees half a file.
  const std::string temporary = fmt::format("{}.{}", path, getpid());
  std::ofstream file(temporary, std::ios::binary);
  file.write(reinterpret_cast<const char*>(binaries.front().data()),
             static_cast<std::streamsize>(binaries.front().size()));
  file.close();
  std::error_code code;
  if (file) fs::rename(temporary, path, code);
  if (!file || code) fs::remove(temporary, code);
}

cl::Program build_from_container(const cl::Context& context, const Device& device,
                                 const std::string& path) {
  const auto bytes = read_file(path);
  if (!bytes) {
    throw Error(
        fmt::format("{}: cannot be read; {} takes kernels only from a container (see "
                    "partita package --help)",
                    path, device.name));
  }
  try {
    cl::Program program(context, {device.cl}, {*bytes});
    build(program, device, path, "");
    return program;
  } catch (const cl::Error& error) {
    throw DeviceError(
        fmt::format("{}: refused by {} ({})", path, device.name, error_name(error.err())));
  }
}

}  // namespace partita::runtime
