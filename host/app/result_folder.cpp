#include "host/app/result_folder.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "host/app/exit_code.h"

namespace partita::app {
namespace {

namespace fs = std::filesystem;

bool is_earlier(const fs::path& folder, const ResultFiles& results) {
  if (io::is_partial(folder.string(), results.writer)) return true;
  std::ifstream file(folder / results.identity);
  std::string brace, key, value;
  return file >> brace >> key >> value && key == "\"tool\":" && value == "\"partita\",";
}

}  // namespace

void refuse_foreign_folder(const std::string& folder, bool force, const ResultFiles& results) {
  std::error_code code;
  if (!fs::is_directory(folder, code) || fs::is_empty(folder, code)) return;
  if (is_earlier(folder, results)) return;
  if (!force) {
    throw OutputError(
        fmt::format("{}: holds files that no earlier run wrote; choose another --out or add "
                    "--force",
                    folder));
  }
  std::vector<std::string> names = results.files;
  names.insert(names.end(), results.folders.begin(), results.folders.end());
  names.push_back("PARTIAL");
  for (const std::string& name : names) {
    const fs::path path = fs::path(folder) / name;
    if (!fs::exists(fs::symlink_status(path, code))) continue;
    if (fs::is_directory(path, code) && fs::is_empty(path, code)) continue;
    throw OutputError(
        fmt::format("{}: no earlier run wrote it, and even --force does not replace it; choose "
                    "another --out",
                    path.string()));
  }
}

void refuse_unwritable_folder(const std::string& folder) {
  std::error_code code;
  fs::path existing = fs::absolute(folder, code);
  while (!fs::exists(existing, code) && existing.has_relative_path()) {
    existing = existing.parent_path();
  }
  if (!fs::is_directory(existing, code)) {
    throw OutputError(fmt::format("--out {}: '{}' is not a folder", folder, existing.string()));
  }
  if (::access(existing.c_str(), W_OK | X_OK) != 0) {
    throw OutputError(
        fmt::format("--out {}: nothing may be written into '{}'", folder, existing.string()));
  }
}

void remove_earlier_results(const io::OutputFolder& folder, const ResultFiles& results) {
  std::error_code ignored;
  for (const std::string& name : results.files) fs::remove(folder.file(name), ignored);
}

}  // namespace partita::app
