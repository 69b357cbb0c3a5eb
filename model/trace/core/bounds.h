// What becomes of addresses that the memory does not have.
#pragma once
#include <cstdint>
#include <string>

#include "model/common/check.h"
#include "model/trace/core/trace.h"

namespace fovea::trace {

/// The memory that a trace is for.
struct Bounds {
  std::uint64_t size = std::uint64_t{1} << 32;  ///< bytes, a power of two from 1 KiB to 4 GiB
  /// Addresses beyond the memory are taken modulo its size, as a part does that has no wires for
  /// the upper address bits; false: they are an error.
  bool wrap = false;

  /// True if a request may stay where it is.
  bool holds(std::uint64_t address, std::uint64_t bytes) const {
    return address < size && bytes <= size - address;
  }
  /// "64 bytes at 0x10000000 are outside ...", for a message.
  std::string refusal(std::uint64_t address, std::uint64_t bytes) const;
};

/// Hands on the records of another source with their addresses held to the bounds.
class BoundedSource final : public RecordSource {
 public:
  /// `name` is the trace's, for messages; `source` must live as long.
  BoundedSource(std::string name, RecordSource& source, const Bounds& bounds)
      : name_(std::move(name)), source_(source), bounds_(bounds) {}
  bool next(unsigned stream, Record& record) override;
  std::string place(unsigned stream) const override { return source_.place(stream); }

 private:
  std::string name_;
  RecordSource& source_;
  Bounds bounds_;
};

}  // namespace fovea::trace
