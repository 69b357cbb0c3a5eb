#include "sw/fovea/explain/wrapped.h"

#include <sstream>

namespace fovea::app {

std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
  std::string out;
  std::size_t column = indent;
  bool first_line = true;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!first_line) {
      out += "\n" + std::string(indent, ' ');
      column = indent;
    }
    first_line = false;
    bool first_word = true;
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      if (!first_word && column + 1 + word.size() > width) {
        out += "\n" + std::string(indent, ' ');
        column = indent;
      } else if (!first_word) {
        out += ' ';
        ++column;
      }
      out += word;
      column += word.size();
      first_word = false;
    }
  }
  return out;
}

}  // namespace fovea::app
