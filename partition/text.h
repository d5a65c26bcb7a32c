// Small helpers for reading the command line's texts. Inside the partition library only.
#ifndef PARTITA_PARTITION_TEXT_H
#define PARTITA_PARTITION_TEXT_H

#include <string>
#include <string_view>

namespace partita::partition {

/// Without spaces and tabs at both ends.
inline std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Adds to a list "a, b, c".
inline void append(std::string& list, std::string_view item) {
  list.append(list.empty() ? "" : ", ").append(item);
}

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_TEXT_H
