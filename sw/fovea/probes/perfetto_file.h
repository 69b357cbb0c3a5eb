// A trace file in Perfetto's own format (https://perfetto.dev), of bounded size.
#pragma once
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/units.h"
#include "sw/fovea/files/output_file.h"

namespace fovea::app {

/// Events may come in any order of time. They are kept encoded in memory, at most so many bytes of them; finish()
/// writes them. Times are cut to whole nanoseconds, which is what the format has.
class PerfettoFile {
 public:
  using Track = std::uint64_t;
  /// Which events are kept if not all have room. kOldest: tracks of many events end when three quarters are full,
  /// so that the others go on.
  enum class Keep : std::uint8_t { kOldest, kNewest };
  enum class Events : std::uint8_t { kFew, kMany };
  static constexpr Track kNone = 0;  ///< a track that is not wanted: its events are dropped

  /// Opens the file. `wanted` says which tracks are recorded, by their full names ("masters/arm_d").
  /// @throws UserError
  PerfettoFile(const std::filesystem::path& file, std::size_t bytes, Keep keep,
               std::function<bool(const std::string&)> wanted);

  /// Whether a track is recorded.
  bool wants(const std::string& group, const std::string& name) const { return wanted_(group + "/" + name); }
  /// A track for slices and instants, in a group of tracks.
  Track track(const std::string& group, const std::string& name, Events events = Events::kFew);
  /// A track for values in this unit.
  Track counter(const std::string& group, const std::string& name, const std::string& unit);

  /// Slices of one track must not overlap, unless one contains the other.
  /// @param flow events with the same number are joined by arrows, in the order of their times; 0: none
  void slice(Track track, std::string_view name, Picoseconds begin, Picoseconds end,
             std::uint64_t flow = 0);
  void instant(Track track, std::string_view name, Picoseconds at);
  void value(Track track, Picoseconds at, std::int64_t value);
  void value(Track track, Picoseconds at, double value);

  /// Packets that had no room, and the time of the one next to what was kept: of the newest or, with kOldest, of the
  /// oldest.
  std::uint64_t dropped() const { return dropped_; }
  Picoseconds dropped_at() const { return dropped_at_; }
  /// About how many bytes all of them would take.
  std::size_t bytes_wanted() const;
  /// Names of all tracks that were asked for.
  const std::vector<std::string>& tracks() const { return names_; }
  /// Writes the file and gives it its name. @throws UserError
  void finish();

 private:
  struct Chunk {
    std::string packets;
    std::uint64_t count = 0;
    Picoseconds newest = 0;
  };
  Track declare(const std::string& group, const std::string& name, const std::string* unit, Events events);
  bool has_room(Track track, Picoseconds at, unsigned packets);
  void drop_oldest();
  template <class F>
  void event(Track track, Picoseconds at, int type, F fill);

  OutputFile file_;
  std::size_t most_;
  Keep keep_;
  std::function<bool(const std::string&)> wanted_;
  std::string descriptors_, packet_, inner_;
  std::vector<std::string> names_;
  std::vector<std::pair<std::string, Track>> groups_;
  Track last_ = 0;
  std::deque<Chunk> chunks_;
  std::size_t bytes_ = 0;
  std::vector<bool> many_{false};  // by track: has many events
  std::uint64_t kept_ = 0, dropped_ = 0;
  Picoseconds dropped_at_ = 0;
};

/// Tracks for things that may overlap, such as the requests of a master: each goes to the first track
/// that is free.
class PerfettoLanes {
 public:
  PerfettoLanes(PerfettoFile& file, std::string group, std::string name)
      : file_(file), group_(std::move(group)), name_(std::move(name)) {}
  void slice(std::string_view name, Picoseconds begin, Picoseconds end);

 private:
  struct Lane {
    PerfettoFile::Track track;
    Picoseconds free;
  };
  PerfettoFile& file_;
  std::string group_, name_;
  std::vector<Lane> lanes_;
};

}  // namespace fovea::app
