# Writes OUT: assets.cpp with the page's style and script. The files of SCRIPTS are joined in their order.
set(style "")
file(READ ${FOLDER}/page.css style)
set(script "")
foreach(name IN LISTS SCRIPTS)
  file(READ ${FOLDER}/${name} text)
  string(APPEND script "${text}")
endforeach()
file(WRITE ${OUT} "// Made by assets.cmake.\n#include \"sw/fovea/report/assets.h\"\n
namespace fovea::report {
const std::string_view kStyle = R\"FOVEA(${style})FOVEA\";
const std::string_view kScript = R\"FOVEA(${script})FOVEA\";
}  // namespace fovea::report\n")
