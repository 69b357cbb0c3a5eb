// Observer interface of the D-cache's lines, for checkers beside the core.
#pragma once

namespace fovea::cpu {

/// Lines are numbered as in Cache. Accesses that hit a hint are not announced, which is why a hit costs
/// nothing: an observer that needs every access to a line watches it (Core::watch_line), so that the line
/// has no hints. Loads are announced to all observers, whichever watches the line. An observer changes nothing else.
class LineWatch {
 public:
  virtual ~LineWatch() = default;
  /// The line holds new contents, and all other processes have acted up to the core's time.
  virtual void filled(unsigned line) = 0;
  /// A load of `bytes` from byte `offset` of a watched line.
  virtual void loaded(unsigned line, unsigned offset, unsigned bytes) = 0;
  /// A store into a line without a hint: at least the first one after which a half is dirty.
  virtual void stored(unsigned line, unsigned offset, unsigned bytes) = 0;
  /// The dirty halves of the line (one bit each) have been moved to the victim buffer.
  virtual void written_back(unsigned line, unsigned halves) = 0;
};

}  // namespace fovea::cpu
