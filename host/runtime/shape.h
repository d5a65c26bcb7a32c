// Shape: the named integers that a launch depends on: sizes ("width", "height"), and counts that
// become known when it runs ("keypoints"). Small (a handful of entries), ordered, printable.
#ifndef PARTITA_HOST_RUNTIME_SHAPE_H
#define PARTITA_HOST_RUNTIME_SHAPE_H

#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace partita::runtime {

class Shape {
 public:
  using Entry = std::pair<std::string_view, std::int64_t>;

  Shape() = default;
  /// Names must be string literals: a shape is made for every launch and does not copy them.
  Shape(std::initializer_list<Entry> entries);

  /// Throws Error that names the missing entry and the ones there are.
  std::int64_t operator[](std::string_view name) const;
  bool has(std::string_view name) const;
  /// A copy with one entry added or replaced.
  Shape with(std::string_view name, std::int64_t value) const;
  std::span<const Entry> entries() const { return {entries_.data(), size_}; }
  /// "width=64 height=48"
  std::string to_string() const;

 private:
  void set(std::string_view name, std::int64_t value);

  static constexpr std::size_t kCapacity = 12;
  std::array<Entry, kCapacity> entries_{};
  std::size_t size_ = 0;
};

}  // namespace partita::runtime

#endif  // PARTITA_HOST_RUNTIME_SHAPE_H
