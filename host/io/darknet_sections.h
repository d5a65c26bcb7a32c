// A .cfg cut into sections of options, before anything is known of layers.
#ifndef PARTITA_HOST_IO_DARKNET_SECTIONS_H
#define PARTITA_HOST_IO_DARKNET_SECTIONS_H

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace partita::io::darknet {

/// One [name] and the options below it. Reading an option marks it; expect_all_read() then
/// complains about the first that nobody asked for. Every complaint is an Error with file and line.
class Section {
 public:
  Section(const std::string& path, std::string name, std::size_t line)
      : path_(&path), name_(std::move(name)), line_(line) {}

  const std::string& name() const { return name_; }
  std::size_t line() const { return line_; }
  void add(const std::string& key, const std::string& value, std::size_t line);

  bool has(const std::string& key) const { return options_.contains(key); }
  int integer(const std::string& key, int otherwise, int least, int most);
  int required_integer(const std::string& key, int least, int most);
  float real(const std::string& key, float otherwise, float least, float most);
  std::string word(const std::string& key, const std::string& otherwise);
  /// Numbers between commas; none if the option is absent.
  std::vector<int> integers(const std::string& key, int least, int most);
  std::vector<float> reals(const std::string& key, float least, float most);
  /// Options that matter to training alone.
  void ignore(std::initializer_list<const char*> keys);
  void expect_all_read() const;

  [[noreturn]] void fail(std::string_view message) const;
  [[noreturn]] void fail(const std::string& key, std::string_view message) const;

 private:
  struct Option {
    std::string value;
    std::size_t line = 0;
    bool read = false;
  };
  template <typename T>
  T number(const std::string& key, std::string_view text, T least, T most) const;
  template <typename T>
  std::vector<T> list(const std::string& key, T least, T most);

  const std::string* path_;
  std::string name_;
  std::size_t line_ = 0;
  std::map<std::string, Option> options_;
};

/// `path` is for messages and must outlive the sections.
std::vector<Section> parse_sections(std::string_view text, const std::string& path);

}  // namespace partita::io::darknet

#endif  // PARTITA_HOST_IO_DARKNET_SECTIONS_H
