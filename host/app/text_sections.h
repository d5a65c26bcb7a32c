// Several kernel files in one translation unit: an FPGA's container holds one text for all its
// kernels, while every kernel file is written as a unit of its own, with helpers and macros whose
// names may collide with another file's.
#ifndef PARTITA_HOST_APP_TEXT_SECTIONS_H
#define PARTITA_HOST_APP_TEXT_SECTIONS_H

#include <string>
#include <string_view>
#include <vector>

namespace partita::app {

/// What a flattened kernel file declares at its top level.
struct TopLevelNames {
  std::vector<std::string> declared;  ///< helper functions, types, constants; no kernels
  std::vector<std::string> macros;    ///< #define NAME
};
TopLevelNames top_level_names(std::string_view text);

/// One kernel file of the translation unit. `options` holds -DNAME or -DNAME=VALUE words.
struct TextSection {
  std::string file;
  std::string text;
  std::string options;
};

/// The sections after one another; each one's helpers are renamed with its number and its macros
/// end with it, so that no section sees another's. Throws Error for options other than -D.
std::string join_sections(const std::vector<TextSection>& sections);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_TEXT_SECTIONS_H
