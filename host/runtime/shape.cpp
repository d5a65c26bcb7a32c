#include "host/runtime/shape.h"

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::runtime {

Shape::Shape(std::initializer_list<Entry> entries) {
  for (const auto& [name, value] : entries) set(name, value);
}

std::int64_t Shape::operator[](std::string_view name) const {
  for (const Entry& entry : entries()) {
    if (entry.first == name) return entry.second;
  }
  throw Error(fmt::format("shape has no entry '{}': it has {}", name, to_string()));
}

bool Shape::has(std::string_view name) const {
  for (const Entry& entry : entries()) {
    if (entry.first == name) return true;
  }
  return false;
}

Shape Shape::with(std::string_view name, std::int64_t value) const {
  Shape copy = *this;
  copy.set(name, value);
  return copy;
}

std::string Shape::to_string() const {
  std::string text;
  for (const auto& [name, value] : entries()) {
    text += fmt::format("{}{}={}", text.empty() ? "" : " ", name, value);
  }
  return text;
}

void Shape::set(std::string_view name, std::int64_t value) {
  for (std::size_t i = 0; i < size_; ++i) {
    if (entries_[i].first == name) {
      entries_[i].second = value;
      return;
    }
  }
  if (size_ == kCapacity) {
    throw Error(fmt::format("shape takes {} entries, '{}' is one more", kCapacity, name));
  }
  entries_[size_++] = {name, value};
}

}  // namespace partita::runtime
