#include "host/app/text_sections.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::app {
namespace {

bool word_char(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// The tokens of OpenCL C that matter here: words and single punctuation; comments, literals and
/// preprocessor lines are skipped, except that `macros` collects the names of #define.
std::vector<std::string_view> tokenize(std::string_view text, std::set<std::string>& macros) {
  std::vector<std::string_view> tokens;
  bool line_start = true;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '\n') {
      line_start = true;
      ++i;
    } else if (std::isspace(static_cast<unsigned char>(c)) != 0) {
      ++i;
    } else if (text.substr(i, 2) == "//") {
      i = std::min(text.find('\n', i), text.size());
    } else if (text.substr(i, 2) == "/*") {
      i = std::min(text.find("*/", i), text.size() - 2) + 2;
    } else if (c == '#' && line_start) {
      std::size_t end = text.find('\n', i);
      while (end != std::string_view::npos && text[end - 1] == '\\') end = text.find('\n', end + 1);
      std::istringstream line(std::string(text.substr(i + 1, end - i - 1)));
      std::string directive, name;
      line >> directive >> name;
      const auto stop = std::find_if_not(name.begin(), name.end(), word_char);
      if (directive == "define") macros.insert(std::string(name.begin(), stop));
      i = std::min(end, text.size());
    } else if (c == '"' || c == '\'') {
      for (++i; i < text.size() && text[i] != c; ++i) i += text[i] == '\\' ? 1 : 0;
      ++i;
      line_start = false;
    } else {
      const std::size_t begin = i++;
      while (word_char(c) && i < text.size() && word_char(text[i])) ++i;
      tokens.push_back(text.substr(begin, i - begin));
      line_start = false;
    }
  }
  return tokens;
}

bool is_name(std::string_view token) {
  return word_char(token[0]) && std::isdigit(static_cast<unsigned char>(token[0])) == 0;
}

/// Index behind the bracket that closes the one at `open`.
std::size_t skip_brackets(const std::vector<std::string_view>& tokens, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < tokens.size(); ++i) {
    const char c = tokens[i][0];
    if (c == '(' || c == '{' || c == '[') ++depth;
    if ((c == ')' || c == '}' || c == ']') && --depth == 0) return i + 1;
  }
  return tokens.size();
}

/// Adds the names that one top-level declaration gives; none for a kernel. What stands in brackets
/// has been left out: what remains of a function is "type name (", of an array "constant type name
/// [", of a type "typedef struct tag { name".
void add_declared(const std::vector<std::string_view>& flat, std::set<std::string>& names) {
  std::string_view last;
  for (std::size_t i = 0; i < flat.size(); ++i) {
    if (flat[i] == "kernel" || flat[i] == "__kernel") return;
    const bool tagged = flat[i] == "struct" || flat[i] == "union" || flat[i] == "enum";
    if (tagged && i + 2 < flat.size() && flat[i + 2] == "{") names.emplace(flat[i + 1]);
    if (flat[i] == "__attribute__") {
      ++i;  // and its bracket
    } else if (flat[i] == "(" || flat[i] == "[" || flat[i] == "=") {
      if (!last.empty()) break;
    } else if (is_name(flat[i])) {
      last = flat[i];
    }
  }
  if (!last.empty()) names.emplace(last);
}

}  // namespace

TopLevelNames top_level_names(std::string_view text) {
  std::set<std::string> macros, names;
  const std::vector<std::string_view> tokens = tokenize(text, macros);
  std::vector<std::string_view> flat;
  const auto end_declaration = [&] {
    add_declared(flat, names);
    flat.clear();
  };
  for (std::size_t i = 0; i < tokens.size();) {
    const char c = tokens[i][0];
    if (c == ';') {
      end_declaration();
      ++i;
    } else if (c == '(' || c == '[' || c == '{') {
      // A body ends a function; a struct's or an initialiser's braces do not end the declaration.
      const bool body = c == '{' && !flat.empty() && flat.back() == "(";
      flat.push_back(tokens[i]);
      i = skip_brackets(tokens, i);
      if (body) end_declaration();
    } else {
      flat.push_back(tokens[i++]);
    }
  }
  for (const std::string& macro : macros) names.erase(macro);
  return {{names.begin(), names.end()}, {macros.begin(), macros.end()}};
}

std::string join_sections(const std::vector<TextSection>& sections) {
  std::string joined;
  for (std::size_t number = 0; const TextSection& section : sections) {
    const TopLevelNames names = top_level_names(section.text);
    std::string before, after;
    std::istringstream words(section.options);
    for (std::string word; words >> word;) {
      if (!word.starts_with("-D")) {
        throw Error(fmt::format("kernels/{}: option {} cannot go into a container, only -D can",
                                section.file, word));
      }
      const std::size_t equals = std::min(word.find('='), word.size());
      const std::string name = word.substr(2, equals - 2);
      const std::string value = equals < word.size() ? word.substr(equals + 1) : "1";
      before += fmt::format("#define {} {}\n", name, value);
      after += fmt::format("#undef {}\n", name);
    }
    for (const std::string& name : names.declared) {
      before += fmt::format("#define {} {}_s{}\n", name, name, number);
      after += fmt::format("#undef {}\n", name);
    }
    for (const std::string& name : names.macros) after += fmt::format("#undef {}\n", name);
    joined += fmt::format("// ---- kernels/{}\n{}{}{}", section.file, before, section.text, after);
    ++number;
  }
  return joined;
}

}  // namespace partita::app
