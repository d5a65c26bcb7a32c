#include "host/io/json_file.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/io/file.h"
#include "host/runtime/error.h"

namespace partita::io {

void write_json(const std::string& path, const nlohmann::ordered_json& value) {
  // Names of files may hold any bytes; what is not UTF-8 is replaced rather than refused.
  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  write_file(path, value.dump(2, ' ', false, kReplace) + "\n");
}

nlohmann::ordered_json read_json(const std::string& path) {
  const std::string text = read_file(path);
  try {
    return nlohmann::ordered_json::parse(text);
  } catch (const nlohmann::json::parse_error& e) {
    const std::size_t at = std::min(e.byte, text.size());
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n');
    throw Error(fmt::format("{}:{}: not JSON", path, line));
  } catch (const nlohmann::json::out_of_range&) {
    throw Error(fmt::format("{}: number overflow: one is too large to be read", path));
  }
}

}  // namespace partita::io
