#include "sw/fovea/probes/perfetto_file.h"

#include <algorithm>
#include <protozero/pbf_builder.hpp>

#include "sw/fovea/probes/proto.h"

namespace fovea::app {
namespace {

using perfetto::CounterDescriptor;
using perfetto::Trace;
using perfetto::TracePacket;
using perfetto::TrackDescriptor;
using perfetto::TrackEvent;
using perfetto::TrackEventType;
using protozero::pbf_builder;

constexpr std::uint32_t kSequence = 1;  // of all packets: one writer
constexpr std::size_t kChunk = 256 << 10;

/// Any trace begins with a packet: the tag of Trace.packet.
constexpr char kFirstByte = 0x0A;

}  // namespace

PerfettoFile::PerfettoFile(const std::filesystem::path& file, std::size_t bytes, Keep keep,
                           std::function<bool(const std::string&)> wanted)
    : file_(file, "--perfetto", "a Perfetto trace",
            [](std::string_view first) { return first.starts_with(kFirstByte); }),
      most_(bytes),
      keep_(keep),
      wanted_(std::move(wanted)) {}

PerfettoFile::Track PerfettoFile::declare(const std::string& group, const std::string& name,
                                          const std::string* unit, Events events) {
  const std::string full = group + "/" + name;
  names_.push_back(full);
  if (!wanted_(full)) return kNone;
  const auto describe = [&](const std::string& label, Track parent, const std::string* of_unit) {
    pbf_builder<Trace> trace(descriptors_);
    pbf_builder<TracePacket> packet(trace, Trace::kPacket);
    packet.add_uint32(TracePacket::kTrustedPacketSequenceId, kSequence);
    pbf_builder<TrackDescriptor> track(packet, TracePacket::kTrackDescriptor);
    track.add_uint64(TrackDescriptor::kUuid, ++last_);
    track.add_string(TrackDescriptor::kName, label);
    many_.push_back(events == Events::kMany);
    if (parent) track.add_uint64(TrackDescriptor::kParentUuid, parent);
    if (of_unit) {
      pbf_builder<CounterDescriptor> counter(track, TrackDescriptor::kCounter);
      counter.add_string(CounterDescriptor::kUnitName, *of_unit);
    }
    return last_;
  };
  auto parent = std::find_if(groups_.begin(), groups_.end(), [&](const auto& g) { return g.first == group; });
  if (parent == groups_.end()) {
    groups_.emplace_back(group, describe(group, kNone, nullptr));
    parent = groups_.end() - 1;
  }
  return describe(name, parent->second, unit);
}

PerfettoFile::Track PerfettoFile::track(const std::string& group, const std::string& name, Events events) {
  return declare(group, name, nullptr, events);
}

PerfettoFile::Track PerfettoFile::counter(const std::string& group, const std::string& name,
                                          const std::string& unit) {
  return declare(group, name, &unit, Events::kFew);
}

/// With kOldest, what is full stays so.
bool PerfettoFile::has_room(Track track, Picoseconds at, unsigned packets) {
  if (keep_ == Keep::kNewest || bytes_ < (many_[track] ? most_ - most_ / 4 : most_)) return true;
  dropped_at_ = dropped_ == 0 ? at : std::min(dropped_at_, at);
  dropped_ += packets;
  return false;
}

void PerfettoFile::drop_oldest() {
  bytes_ -= chunks_.front().packets.size();
  dropped_ += chunks_.front().count;
  kept_ -= chunks_.front().count;
  dropped_at_ = std::max(dropped_at_, chunks_.front().newest);
  chunks_.pop_front();
}

std::size_t PerfettoFile::bytes_wanted() const {
  return kept_ == 0 ? 0 : static_cast<std::size_t>(static_cast<double>(bytes_) / static_cast<double>(kept_) *
                                                   static_cast<double>(kept_ + dropped_));
}

template <class F>
void PerfettoFile::event(Track track, Picoseconds at, int type, F fill) {
  inner_.clear();
  {
    pbf_builder<TrackEvent> event(inner_);
    event.add_enum(TrackEvent::kType, type);
    event.add_uint64(TrackEvent::kTrackUuid, track);
    fill(event);
  }
  packet_.clear();
  {
    pbf_builder<TracePacket> packet(packet_);
    packet.add_uint64(TracePacket::kTimestamp, at / kPsPerNs);
    packet.add_uint32(TracePacket::kTrustedPacketSequenceId, kSequence);
    packet.add_message(TracePacket::kTrackEvent, inner_);
  }
  // The end of a slice goes with its beginning.
  const bool full = !chunks_.empty() && chunks_.back().packets.size() >= kChunk;
  if (chunks_.empty() || (full && type != static_cast<int>(TrackEventType::kSliceEnd))) chunks_.emplace_back();
  Chunk& chunk = chunks_.back();
  const std::size_t before = chunk.packets.size();
  pbf_builder<Trace>(chunk.packets).add_message(Trace::kPacket, packet_);
  bytes_ += chunk.packets.size() - before;
  ++chunk.count;
  ++kept_;
  chunk.newest = std::max(chunk.newest, at);
  while (keep_ == Keep::kNewest && bytes_ > most_ && chunks_.size() > 1) drop_oldest();
}

void PerfettoFile::slice(Track track, std::string_view name, Picoseconds begin, Picoseconds end,
                         std::uint64_t flow) {
  if (track == kNone || !has_room(track, begin, 2)) return;
  event(track, begin, static_cast<int>(TrackEventType::kSliceBegin), [&](pbf_builder<TrackEvent>& e) {
    e.add_string(TrackEvent::kName, name.data(), name.size());
    if (flow) e.add_fixed64(TrackEvent::kFlowIds, flow);
  });
  event(track, end, static_cast<int>(TrackEventType::kSliceEnd), [](auto&) {});
}

void PerfettoFile::instant(Track track, std::string_view name, Picoseconds at) {
  if (track == kNone || !has_room(track, at, 1)) return;
  event(track, at, static_cast<int>(TrackEventType::kInstant), [&](pbf_builder<TrackEvent>& e) {
    e.add_string(TrackEvent::kName, name.data(), name.size());
  });
}

void PerfettoFile::value(Track track, Picoseconds at, std::int64_t value) {
  if (track == kNone || !has_room(track, at, 1)) return;
  event(track, at, static_cast<int>(TrackEventType::kCounter), [&](pbf_builder<TrackEvent>& e) {
    e.add_int64(TrackEvent::kCounterValue, value);
  });
}

void PerfettoFile::value(Track track, Picoseconds at, double value) {
  if (track == kNone || !has_room(track, at, 1)) return;
  event(track, at, static_cast<int>(TrackEventType::kCounter), [&](pbf_builder<TrackEvent>& e) {
    e.add_double(TrackEvent::kDoubleCounterValue, value);
  });
}

void PerfettoFile::finish() {
  file_.write(descriptors_);
  for (const Chunk& chunk : chunks_) file_.write(chunk.packets);
  file_.commit();
}

void PerfettoLanes::slice(std::string_view name, Picoseconds begin, Picoseconds end) {
  auto lane = std::find_if(lanes_.begin(), lanes_.end(), [&](const Lane& l) { return l.free <= begin; });
  if (lane == lanes_.end()) {
    const std::string number = lanes_.empty() ? "" : " (" + std::to_string(lanes_.size() + 1) + ")";
    lanes_.push_back({file_.track(group_, name_ + number, PerfettoFile::Events::kMany), 0});
    lane = lanes_.end() - 1;
  }
  lane->free = end;
  file_.slice(lane->track, name, begin, end);
}

}  // namespace fovea::app
