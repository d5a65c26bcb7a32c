# Writes OUTPUT, a C++ file with the text of FILES (relative to ROOT), as host/runtime/sources.h
# declares it.
set(text "// Generated from kernels/*; edit those.\n#include \"host/runtime/sources.h\"\n\n")
string(APPEND text "namespace partita::runtime {\nnamespace {\nconstexpr EmbeddedFile kFiles[] = {\n")
foreach(file IN LISTS FILES)
  file(READ ${ROOT}/${file} content)
  string(APPEND text "{\"${file}\", R\"==cl==(${content})==cl==\"},\n")
endforeach()
string(APPEND text "};\n}  // namespace\n\n")
string(APPEND text "std::span<const EmbeddedFile> embedded_kernels() { return kFiles; }\n\n")
string(APPEND text "}  // namespace partita::runtime\n")
file(WRITE ${OUTPUT} "${text}")
