#include "sw/fovea/perfetto/perfetto_file.h"

#include <algorithm>
#include <protozero/pbf_builder.hpp>

#include "sw/fovea/perfetto/proto.h"

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

PerfettoFile::PerfettoFile(const std::filesystem::path& file, std::size_t ring_bytes,
                           std::function<bool(const std::string&)> wanted)
    : file_(file, "--perfetto", "a Perfetto trace",
            [](std::string_view first) { return first.starts_with(kFirstByte); }),
      ring_bytes_(ring_bytes),
      wanted_(std::move(wanted)) {}

PerfettoFile::Track PerfettoFile::declare(const std::string& group, const std::string& name,
                                          const std::string* unit) {
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

PerfettoFile::Track PerfettoFile::track(const std::string& group, const std::string& name) {
  return declare(group, name, nullptr);
}

PerfettoFile::Track PerfettoFile::counter(const std::string& group, const std::string& name,
                                          const std::string& unit) {
  return declare(group, name, &unit);
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
  chunk.newest = std::max(chunk.newest, at);
  while (bytes_ > ring_bytes_ && chunks_.size() > 1) {
    bytes_ -= chunks_.front().packets.size();
    dropped_ += chunks_.front().count;
    dropped_until_ = std::max(dropped_until_, chunks_.front().newest);
    chunks_.pop_front();
  }
}

void PerfettoFile::slice(Track track, std::string_view name, Picoseconds begin, Picoseconds end,
                         std::uint64_t flow) {
  if (track == kNone) return;
  event(track, begin, static_cast<int>(TrackEventType::kSliceBegin), [&](pbf_builder<TrackEvent>& e) {
    e.add_string(TrackEvent::kName, name.data(), name.size());
    if (flow) e.add_fixed64(TrackEvent::kFlowIds, flow);
  });
  event(track, end, static_cast<int>(TrackEventType::kSliceEnd), [](auto&) {});
}

void PerfettoFile::instant(Track track, std::string_view name, Picoseconds at) {
  if (track == kNone) return;
  event(track, at, static_cast<int>(TrackEventType::kInstant), [&](pbf_builder<TrackEvent>& e) {
    e.add_string(TrackEvent::kName, name.data(), name.size());
  });
}

void PerfettoFile::value(Track track, Picoseconds at, std::int64_t value) {
  if (track == kNone) return;
  event(track, at, static_cast<int>(TrackEventType::kCounter), [&](pbf_builder<TrackEvent>& e) {
    e.add_int64(TrackEvent::kCounterValue, value);
  });
}

void PerfettoFile::value(Track track, Picoseconds at, double value) {
  if (track == kNone) return;
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
    lanes_.push_back({file_.track(group_, name_ + number), 0});
    lane = lanes_.end() - 1;
  }
  lane->free = end;
  file_.slice(lane->track, name, begin, end);
}

}  // namespace fovea::app
