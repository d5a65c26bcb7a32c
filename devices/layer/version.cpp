#include "devices/layer/version.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

namespace partita::layer {

cl_version parse_version(std::string_view text, std::string_view prefix) {
  unsigned major = 1, minor = 0;
  if (text.substr(0, prefix.size()) == prefix) {
    const std::string digits(text.substr(prefix.size()));
    if (std::sscanf(digits.c_str(), "%u.%u", &major, &minor) != 2) major = 1, minor = 0;
  }
  return CL_MAKE_VERSION(major, minor, 0);
}

std::vector<std::string> split_words(std::string_view text) {
  std::vector<std::string> words;
  std::size_t at = 0;
  while ((at = text.find_first_not_of(' ', at)) != std::string_view::npos) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    words.emplace_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

cl_name_version name_version(std::string_view name, cl_version version) {
  cl_name_version entry{};
  entry.version = version;
  std::memcpy(entry.name, name.data(), std::min(name.size(), sizeof entry.name - 1));
  return entry;
}

std::vector<cl_name_version> with_versions(const std::vector<std::string>& extensions) {
  std::vector<cl_name_version> list;
  for (const std::string& e : extensions) list.push_back(name_version(e, CL_MAKE_VERSION(1, 0, 0)));
  return list;
}

}  // namespace partita::layer
