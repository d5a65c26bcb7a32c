// JSON on disk.
#ifndef PARTITA_HOST_IO_JSON_FILE_H
#define PARTITA_HOST_IO_JSON_FILE_H

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace partita::io {

/// Writes it indented, keys in their order of insertion, as one atomic file.
void write_json(const std::string& path, const nlohmann::ordered_json& value);

/// Throws Error with file, line and column of what is not JSON.
nlohmann::ordered_json read_json(const std::string& path);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_JSON_FILE_H
