#include "devices/profile/reader.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>

namespace partita::profile {
namespace {

constexpr std::size_t kMaxFile = 1 << 20;

std::string shown(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

std::string expectation(Range range, bool whole) {
  std::string text = whole ? "a whole number" : "a number";
  if (*range.unit) text += std::string(" of ") + range.unit;
  return text + " in [" + shown(range.low) + ", " + shown(range.high) + "]";
}

/// What a value looks like in an error: short and on one line.
std::string excerpt(const YAML::Node& node) {
  if (node.IsMap()) return "a mapping";
  if (node.IsSequence()) return "a list";
  if (node.IsNull()) return "nothing";
  std::string text = node.Scalar().substr(0, 40);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 32; }, ' ');
  return "'" + text + "'";
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t up = row[j + 1];
      row[j + 1] = std::min({up + 1, row[j] + 1, diagonal + (a[i] == b[j] ? 0 : 1)});
      diagonal = up;
    }
  }
  return row.back();
}

/// Whole text as a finite number; decimal, or hexadecimal for integers.
bool parse_number(const YAML::Node& node, double& value) {
  if (!node.IsScalar() || node.Tag() == "!") return false;  // "!": it was quoted
  const std::string& text = node.Scalar();
  const bool hex = text.starts_with("0x");
  if (text.empty() || text.size() > 40) return false;
  if (text.find_first_not_of(hex ? "0123456789abcdefABCDEFx" : "0123456789+-.eE") !=
      std::string::npos) {
    return false;
  }
  char* end = nullptr;
  value = std::strtod(text.c_str(), &end);
  return *end == '\0' && std::isfinite(value);
}

bool valid_date(const std::string& text) {
  const auto digits = [&](std::size_t from, std::size_t to) {
    return std::all_of(text.begin() + static_cast<long>(from), text.begin() + static_cast<long>(to),
                       [](unsigned char c) { return c >= '0' && c <= '9'; });
  };
  const std::size_t n = text.size();
  if (n != 4 && n != 7 && n != 10) return false;
  return digits(0, 4) && (n < 7 || (text[4] == '-' && digits(5, 7))) &&
         (n < 10 || (text[7] == '-' && digits(8, 10)));
}

}  // namespace

Reader::Reader(YAML::Node node, std::string path, std::string prefix,
               std::vector<Provenance>* numbers)
    : node_(std::move(node)),
      path_(std::move(path)),
      prefix_(std::move(prefix)),
      numbers_(numbers) {}

Reader Reader::parse(const std::string& text, const std::string& path,
                     std::vector<Provenance>* numbers) {
  try {
    const YAML::Node root = YAML::Load(text);
    if (!root.IsMap()) throw Error(path + ":1: not a YAML mapping, expected 'key: value' lines");
    Reader reader(root, path, "", numbers);
    reader.inherit(root, reader.source_, reader.date_, "");
    return reader;
  } catch (const YAML::Exception& e) {
    // The message may quote the file's own bytes, a line's end among them.
    throw Error(path + ":" + std::to_string(std::max(e.mark.line, 0) + 1) +
                ": not valid YAML: " + e.msg.substr(0, e.msg.find_first_of("\r\n")));
  }
}

std::string Reader::full(std::string_view key) const {
  return prefix_.empty() ? std::string(key) : prefix_ + "." + std::string(key);
}

void Reader::fail(std::string_view key, const std::string& what) const {
  YAML::Mark mark = node_.Mark();
  for (const auto& entry : node_) {
    if (entry.first.IsScalar() && entry.first.Scalar() == key) mark = entry.first.Mark();
  }
  throw Error(path_ + ":" + std::to_string(std::max(mark.line, 0) + 1) + ": " + full(key) + ": " +
              what);
}

YAML::Node Reader::find(std::string_view key) const {
  for (const auto& entry : node_) {
    if (entry.first.IsScalar() && entry.first.Scalar() == key) return entry.second;
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

bool Reader::has(std::string_view key) const {
  return find(key).IsDefined();
}

YAML::Node Reader::require(std::string_view key, const std::string& expected) const {
  YAML::Node value = find(key);
  if (!value.IsDefined()) fail(key, "missing, expected " + expected);
  return value;
}

void Reader::allow(const std::vector<std::string_view>& keys) const {
  std::vector<std::string> seen;
  for (const auto& entry : node_) {
    const YAML::Mark mark = entry.first.Mark();
    const std::string where = path_ + ":" + std::to_string(std::max(mark.line, 0) + 1) + ": ";
    if (!entry.first.IsScalar()) {
      throw Error(where + (prefix_.empty() ? "" : prefix_ + ": ") + "a key that is not a word");
    }
    const std::string& key = entry.first.Scalar();
    if (std::find(seen.begin(), seen.end(), key) != seen.end()) {
      throw Error(where + full(excerpt(entry.first)) + ": given twice, expected once");
    }
    seen.push_back(key);
    if (key == "source" || key == "date") continue;
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    const auto nearest = std::min_element(keys.begin(), keys.end(), [&](auto a, auto b) {
      return edit_distance(key, a) < edit_distance(key, b);
    });
    throw Error(
        where + full(excerpt(entry.first)) + ": unknown key" +
        (nearest == keys.end() ? "" : ", expected perhaps '" + std::string(*nearest) + "'"));
  }
}

std::vector<std::string> Reader::keys() const {
  std::vector<std::string> keys;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) continue;
    const std::string& key = entry.first.Scalar();
    if (key != "source" && key != "date") keys.push_back(key);
  }
  return keys;
}

void Reader::inherit(const YAML::Node& node, std::string& source, std::string& date,
                     std::string_view key) const {
  for (const auto& entry : node) {
    if (!entry.first.IsScalar()) continue;
    const bool is_source = entry.first.Scalar() == "source";
    if (!is_source && entry.first.Scalar() != "date") continue;
    const std::string& name = entry.first.Scalar();
    if (!entry.second.IsScalar() || entry.second.Scalar().size() < 4) {
      fail(key, name + " is " + excerpt(entry.second) + ", expected where the numbers come from");
    }
    (is_source ? source : date) = entry.second.Scalar();
    if (!is_source && !valid_date(date)) {
      fail(key, "date is " + excerpt(entry.second) + ", expected YYYY, YYYY-MM or YYYY-MM-DD");
    }
  }
}

Reader Reader::section(std::string_view key) const {
  const YAML::Node value = require(key, "a section");
  if (!value.IsMap()) fail(key, "is " + excerpt(value) + ", expected a section");
  Reader child(value, path_, full(key), numbers_);
  child.source_ = source_;
  child.date_ = date_;
  child.inherit(value, child.source_, child.date_, "");
  return child;
}

std::string Reader::text(std::string_view key) const {
  const YAML::Node value = require(key, "a text");
  if (!value.IsScalar() || value.Scalar().empty()) {
    fail(key, "is " + excerpt(value) + ", expected a text");
  }
  if (value.Scalar().find_first_of("\n\r") != std::string::npos) {
    fail(key, "has a line break, expected one line");
  }
  return value.Scalar();
}

std::vector<std::string> Reader::texts(std::string_view key) const {
  const YAML::Node value = require(key, "a list of texts");
  if (!value.IsSequence()) fail(key, "is " + excerpt(value) + ", expected a list of texts");
  std::vector<std::string> texts;
  for (const auto& item : value) {
    if (!item.IsScalar()) fail(key, "has " + excerpt(item) + " in it, expected texts");
    texts.push_back(item.Scalar());
  }
  return texts;
}

std::string Reader::words(std::string_view key) const {
  std::string joined;
  for (const std::string& text : texts(key)) joined += (joined.empty() ? "" : " ") + text;
  return joined;
}

bool Reader::flag(std::string_view key) const {
  const YAML::Node value = require(key, "true or false");
  if (!value.IsScalar() || (value.Scalar() != "true" && value.Scalar() != "false")) {
    fail(key, "is " + excerpt(value) + ", expected true or false");
  }
  return value.Scalar() == "true";
}

double Reader::scalar(const YAML::Node& node, std::string_view key, Range range, bool whole) const {
  double value = 0;
  if (!parse_number(node, value)) {
    fail(key, "is " + excerpt(node) + ", expected " + expectation(range, whole));
  }
  if (value < range.low || value > range.high || (whole && value != std::floor(value))) {
    fail(key, shown(value) + ", expected " + expectation(range, whole));
  }
  return value;
}

void Reader::note(std::string_view key, double value, Range range, const std::string& source,
                  const std::string& date, int line) const {
  if (source.empty()) fail(key, "has no source, expected 'source:' beside it or in its section");
  if (date.empty()) fail(key, "has no date, expected 'date:' beside it or in its section");
  if (numbers_) {
    numbers_->push_back({full(key), range.unit, source, date, value, std::max(line, 0) + 1});
  }
}

double Reader::checked(const YAML::Node& node, std::string_view key, Range range,
                       bool whole) const {
  std::string source = source_, date = date_;
  YAML::Node bare = node;
  if (node.IsMap()) {
    Reader quantity(node, path_, full(key), nullptr);
    quantity.allow({"value", "unit"});
    quantity.inherit(node, source, date, "");
    bare.reset(quantity.require("value", expectation(range, whole)));
    const std::string unit = quantity.has("unit") ? quantity.text("unit") : "";
    if (unit != range.unit) {
      fail(key, "unit is '" + unit + "', expected " +
                    (*range.unit ? "'" + std::string(range.unit) + "'" : "none"));
    }
  }
  const double value = scalar(bare, key, range, whole);
  note(key, value, range, source, date, bare.Mark().line);
  return value;
}

double Reader::number(std::string_view key, Range range) const {
  return checked(require(key, expectation(range, false)), key, range, false);
}

std::uint64_t Reader::integer(std::string_view key, Range range) const {
  const double value = checked(require(key, expectation(range, true)), key, range, true);
  return static_cast<std::uint64_t>(value);
}

std::vector<std::uint64_t> Reader::integers(std::string_view key, std::size_t count,
                                            Range range) const {
  const std::string expected =
      "a list of " + std::to_string(count) + ", each " + expectation(range, true);
  const YAML::Node value = require(key, expected);
  if (!value.IsSequence() || value.size() != count) {
    fail(key, "is " + excerpt(value) + ", expected " + expected);
  }
  std::vector<std::uint64_t> numbers;
  for (const auto& item : value) {
    numbers.push_back(static_cast<std::uint64_t>(scalar(item, key, range, true)));
    note(key, static_cast<double>(numbers.back()), range, source_, date_, item.Mark().line);
  }
  return numbers;
}

std::size_t Reader::choice(std::string_view key,
                           const std::vector<std::string_view>& choices) const {
  std::string expected = "one of";
  for (const auto choice : choices) {
    expected += (choice == choices.front() ? " " : ", ") + std::string(choice);
  }
  const YAML::Node value = require(key, expected);
  const auto found =
      value.IsScalar() ? std::find(choices.begin(), choices.end(), value.Scalar()) : choices.end();
  if (found == choices.end()) fail(key, "is " + excerpt(value) + ", expected " + expected);
  return static_cast<std::size_t>(found - choices.begin());
}

std::uint64_t Reader::bits(
    std::string_view key,
    const std::vector<std::pair<std::string_view, std::uint64_t>>& names) const {
  std::string expected = "a list of";
  for (const auto& [name, bit] : names) expected.append(" ").append(name);
  const YAML::Node value = require(key, expected);
  if (!value.IsSequence()) fail(key, "is " + excerpt(value) + ", expected " + expected);
  std::uint64_t sum = 0;
  for (const auto& item : value) {
    const auto found = std::find_if(names.begin(), names.end(), [&](const auto& name) {
      return item.IsScalar() && item.Scalar() == name.first;
    });
    if (found == names.end()) fail(key, "has " + excerpt(item) + " in it, expected " + expected);
    sum |= found->second;
  }
  return sum;
}

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  if (!in || !(bytes << in.rdbuf())) throw Error(path + ": cannot be read");
  if (bytes.str().size() > kMaxFile) throw Error(path + ": larger than 1 MiB, not a profile");
  return bytes.str();
}

bool plain_name(const std::string& name) {
  const auto ok = [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; };
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), ok);
}

std::vector<std::string> yaml_stems(const std::string& folder) {
  namespace fs = std::filesystem;
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() == ".yaml") names.push_back(it->path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "(none there)" : text;
}

}  // namespace partita::profile
