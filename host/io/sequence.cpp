#include "host/io/sequence.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::io {
namespace {

namespace fs = std::filesystem;

bool is_picture(const fs::path& path) {
  static constexpr std::array kExtensions{".png", ".jpg", ".jpeg", ".pgm", ".ppm"};
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

bool is_number(const fs::path& path) {
  const std::string stem = path.stem().string();
  return !stem.empty() && stem.find_first_not_of("0123456789") == std::string::npos;
}

/// Numbers of any length, without converting them.
bool smaller_number(const fs::path& a, const fs::path& b) {
  const auto digits = [](const fs::path& path) {
    const std::string stem = path.stem().string();
    return stem.substr(std::min(stem.find_first_not_of('0'), stem.size()));
  };
  const std::string x = digits(a), y = digits(b);
  if (x.size() != y.size()) return x.size() < y.size();
  return x != y ? x < y : a < b;
}

}  // namespace

std::vector<std::string> list_pictures(const std::string& folder) {
  std::error_code code;
  if (!fs::is_directory(folder, code)) {
    throw Error(fmt::format("sequence '{}': no such folder", folder));
  }
  const fs::path inner = fs::path(folder) / "img";
  const fs::path where = fs::is_directory(inner, code) ? inner : fs::path(folder);
  std::vector<fs::path> found;
  fs::directory_iterator entries(where, code);
  for (const fs::directory_iterator end; !code && entries != end; entries.increment(code)) {
    const fs::path& path = entries->path();
    if (is_picture(path) && !path.filename().string().starts_with('.')) found.push_back(path);
  }
  if (code) throw Error(fmt::format("{}: cannot be listed ({})", where.string(), code.message()));
  if (found.empty()) {
    throw Error(
        fmt::format("{}: no pictures, expected PNG, JPEG, PGM or PPM files", where.string()));
  }
  if (std::all_of(found.begin(), found.end(), is_number)) {
    std::sort(found.begin(), found.end(), smaller_number);
  } else {
    std::sort(found.begin(), found.end());
  }
  std::vector<std::string> paths;
  for (const fs::path& path : found) paths.push_back(path.string());
  return paths;
}

}  // namespace partita::io
