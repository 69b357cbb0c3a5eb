// Field numbers of Perfetto's trace format that are used here, by their names in its schema
// (google/perfetto, protos/perfetto/trace/: trace.proto, trace_packet.proto, track_event/*.proto).
#pragma once
#include <cstdint>

namespace fovea::app::perfetto {

enum class Trace : std::uint32_t { kPacket = 1 };

enum class TracePacket : std::uint32_t {
  kTimestamp = 8,  ///< ns
  kTrustedPacketSequenceId = 10,
  kTrackEvent = 11,
  kTrackDescriptor = 60
};

enum class TrackEvent : std::uint32_t {
  kType = 9,
  kTrackUuid = 11,
  kName = 23,
  kCounterValue = 30,
  kDoubleCounterValue = 44,
  kFlowIds = 47  ///< fixed64
};
enum class TrackEventType : std::int32_t { kSliceBegin = 1, kSliceEnd = 2, kInstant = 3, kCounter = 4 };

enum class TrackDescriptor : std::uint32_t { kUuid = 1, kName = 2, kParentUuid = 5, kCounter = 8 };
enum class CounterDescriptor : std::uint32_t { kUnitName = 6 };

}  // namespace fovea::app::perfetto
