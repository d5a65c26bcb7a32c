#include "host/io/darknet_sections.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::io::darknet {
namespace {

constexpr std::size_t kMostSections = 2000;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\f\v";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) + 1 - first);
}

/// As it may stand in a message.
std::string quoted(std::string_view word) {
  std::string out;
  for (const char c : word.substr(0, 24)) out += (c >= 0x20 && c < 0x7f) ? c : '?';
  return "'" + out + (word.size() > 24 ? "...'" : "'");
}

[[noreturn]] void fail_at(const std::string& path, std::size_t line, std::string_view message) {
  throw Error(fmt::format("{}:{}: {}", path, line, message));
}

}  // namespace

void Section::add(const std::string& key, const std::string& value, std::size_t line) {
  if (!options_.emplace(key, Option{value, line}).second) {
    fail_at(*path_, line, fmt::format("{} is given twice in this [{}]", quoted(key), name_));
  }
}

void Section::fail(std::string_view message) const {
  fail_at(*path_, line_, fmt::format("[{}]: {}", name_, message));
}

void Section::fail(const std::string& key, std::string_view message) const {
  const auto option = options_.find(key);
  if (option == options_.end()) fail(fmt::format("{}: {}", key, message));
  fail_at(*path_, option->second.line,
          fmt::format("[{}] {}={}: {}", name_, key, quoted(option->second.value), message));
}

template <typename T>
T Section::number(const std::string& key, std::string_view text, T least, T most) const {
  const std::string_view word = trimmed(text);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(value >= least) ||
      !(value <= most)) {
    fail(key, fmt::format("expected {} from {} to {}",
                          std::is_integral_v<T> ? "a whole number" : "a number", least, most));
  }
  return value;
}

template <typename T>
std::vector<T> Section::list(const std::string& key, T least, T most) {
  const auto option = options_.find(key);
  if (option == options_.end()) return {};
  option->second.read = true;
  std::vector<T> values;
  std::string_view rest = trimmed(option->second.value);
  if (rest.ends_with(',')) rest.remove_suffix(1);
  while (true) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    values.push_back(number<T>(key, rest.substr(0, comma), least, most));
    if (comma == rest.size()) return values;
    rest.remove_prefix(comma + 1);
  }
}

int Section::integer(const std::string& key, int otherwise, int least, int most) {
  const auto option = options_.find(key);
  if (option == options_.end()) return otherwise;
  option->second.read = true;
  return number<int>(key, option->second.value, least, most);
}

int Section::required_integer(const std::string& key, int least, int most) {
  if (!has(key)) fail(fmt::format("no option '{}'", key));
  return integer(key, least, least, most);
}

float Section::real(const std::string& key, float otherwise, float least, float most) {
  const auto option = options_.find(key);
  if (option == options_.end()) return otherwise;
  option->second.read = true;
  return number<float>(key, option->second.value, least, most);
}

std::string Section::word(const std::string& key, const std::string& otherwise) {
  const auto option = options_.find(key);
  if (option == options_.end()) return otherwise;
  option->second.read = true;
  return option->second.value;
}

std::vector<int> Section::integers(const std::string& key, int least, int most) {
  return list<int>(key, least, most);
}

std::vector<float> Section::reals(const std::string& key, float least, float most) {
  return list<float>(key, least, most);
}

void Section::ignore(std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    if (const auto option = options_.find(key); option != options_.end())
      option->second.read = true;
  }
}

void Section::expect_all_read() const {
  const std::pair<const std::string, Option>* first = nullptr;
  for (const auto& option : options_) {
    if (option.second.read) continue;
    if (first == nullptr || option.second.line < first->second.line) first = &option;
  }
  if (first == nullptr) return;
  fail_at(*path_, first->second.line,
          fmt::format("[{}] has an option {} that is not known", name_, quoted(first->first)));
}

std::vector<Section> parse_sections(std::string_view text, const std::string& path) {
  if (text.find('\0') != text.npos) throw Error(fmt::format("{}: not a text file", path));
  std::vector<Section> sections;
  std::size_t number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = trimmed(text.substr(at, end - at));
    ++number;
    at = end + 1;
    if (line.empty() || line[0] == '#' || line[0] == ';') continue;
    if (line[0] == '[') {
      if (!line.ends_with(']')) fail_at(path, number, "expected [SECTION]");
      if (sections.size() == kMostSections) {
        fail_at(path, number, fmt::format("more than {} sections", kMostSections));
      }
      const std::string_view name = line.substr(1, line.size() - 2);
      if (name.empty() || !std::all_of(name.begin(), name.end(), [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
          })) {
        fail_at(path, number, fmt::format("section {} is not known", quoted(line)));
      }
      sections.emplace_back(path, std::string(name), number);
      continue;
    }
    const std::size_t equals = line.find('=');
    if (equals == line.npos) {
      fail_at(path, number, fmt::format("{} is no option, expected KEY=VALUE", quoted(line)));
    }
    if (sections.empty()) fail_at(path, number, "an option before the first section");
    sections.back().add(std::string(trimmed(line.substr(0, equals))),
                        std::string(trimmed(line.substr(equals + 1))), number);
  }
  return sections;
}

}  // namespace partita::io::darknet
