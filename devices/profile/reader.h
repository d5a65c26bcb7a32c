// A strict view of one mapping of a YAML file: what profiles, machines and pipelines are read with.
#ifndef PARTITA_DEVICES_PROFILE_READER_H
#define PARTITA_DEVICES_PROFILE_READER_H

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "devices/profile/profile.h"

namespace partita::profile {

/// What a number must be.
struct Range {
  const char* unit = "";  ///< "" for counts and shares
  double low = 0, high = 0;
};

/// One mapping: knows its place in the file and the source and date in force. Each reading
/// function removes nothing; unknown keys are found beforehand by `allow`.
class Reader {
 public:
  /// Parses a whole file. Throws Error for anything that is not one YAML mapping.
  static Reader parse(const std::string& text, const std::string& path,
                      std::vector<Provenance>* numbers);

  /// Refuses any key but these, `source` and `date`, and duplicates.
  void allow(const std::vector<std::string_view>& keys) const;
  bool has(std::string_view key) const;
  Reader section(std::string_view key) const;
  /// The mapping's keys other than `source` and `date`, in file order.
  std::vector<std::string> keys() const;

  std::string text(std::string_view key) const;
  /// A list of texts; may be empty.
  std::vector<std::string> texts(std::string_view key) const;
  /// The same joined by spaces.
  std::string words(std::string_view key) const;
  bool flag(std::string_view key) const;
  double number(std::string_view key, Range range) const;
  std::uint64_t integer(std::string_view key, Range range) const;
  std::vector<std::uint64_t> integers(std::string_view key, std::size_t count, Range range) const;
  /// Index of the text at `key` in `choices`.
  std::size_t choice(std::string_view key, const std::vector<std::string_view>& choices) const;
  /// The bits of the listed names.
  std::uint64_t bits(std::string_view key,
                     const std::vector<std::pair<std::string_view, std::uint64_t>>& names) const;

  /// Throws "<path>:<line of key>: <section.key>: <what>".
  [[noreturn]] void fail(std::string_view key, const std::string& what) const;

 private:
  Reader(YAML::Node node, std::string path, std::string prefix, std::vector<Provenance>* numbers);
  YAML::Node find(std::string_view key) const;
  YAML::Node require(std::string_view key, const std::string& expected) const;
  double checked(const YAML::Node& node, std::string_view key, Range range, bool whole) const;
  double scalar(const YAML::Node& node, std::string_view key, Range range, bool whole) const;
  void inherit(const YAML::Node& node, std::string& source, std::string& date,
               std::string_view key) const;
  void note(std::string_view key, double value, Range range, const std::string& source,
            const std::string& date, int line) const;
  std::string full(std::string_view key) const;

  YAML::Node node_;
  std::string path_, prefix_;
  std::string source_, date_;
  std::vector<Provenance>* numbers_;
};

/// The file's bytes; throws Error if it cannot be read or is larger than 1 MiB.
std::string read_file(const std::string& path);

/// Names of files, nodes and tasks: letters, digits, '-' and '_', at most 64, so no path in
/// disguise.
bool plain_name(const std::string& name);
/// Names of the folder's .yaml files without their ending, sorted.
std::vector<std::string> yaml_stems(const std::string& folder);
/// "a, b, c" for an error's list of what there is.
std::string listed(const std::vector<std::string>& names);

}  // namespace partita::profile

#endif  // PARTITA_DEVICES_PROFILE_READER_H
