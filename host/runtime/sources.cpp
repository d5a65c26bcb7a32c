#include "host/runtime/sources.h"

#include <set>

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::runtime {
namespace {

const EmbeddedFile* find_file(std::string_view path) {
  for (const EmbeddedFile& file : embedded_kernels()) {
    if (file.path == path) return &file;
  }
  return nullptr;
}

/// The path in `#include "path"`, or empty for any other line.
std::string_view included_path(std::string_view line) {
  constexpr std::string_view kDirective = "#include \"";
  if (!line.starts_with(kDirective)) return {};
  line.remove_prefix(kDirective.size());
  return line.substr(0, line.find('"'));
}

void append_flattened(std::string_view path, std::set<std::string_view>& seen, std::string& out) {
  const EmbeddedFile* file = find_file(path);
  if (file == nullptr) throw Error(fmt::format("kernels/{}: no such file is embedded", path));
  if (!seen.insert(file->path).second) return;
  std::string_view rest = file->text;
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    if (const std::string_view include = included_path(line); !include.empty()) {
      append_flattened(include, seen, out);
    } else {
      out += line;
      out += '\n';
    }
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  }
}

}  // namespace

std::string_view kernel_file(const KernelSpec& spec, Variant variant) {
  const std::string specific =
      fmt::format("{}/{}.{}.cl", spec.task, spec.source, to_string(variant));
  if (const EmbeddedFile* file = find_file(specific)) return file->path;
  const std::string common = fmt::format("{}/{}.cl", spec.task, spec.source);
  if (const EmbeddedFile* file = find_file(common)) return file->path;
  throw Error(fmt::format("kernel {}: neither kernels/{} nor kernels/{} is embedded", spec.name,
                          specific, common));
}

std::string flattened_source(std::string_view path) {
  std::set<std::string_view> seen;
  std::string out;
  append_flattened(path, seen, out);
  return out;
}

}  // namespace partita::runtime
