// The memory masters under a debugger: which requests wait for whom, and watchpoints on masters
// other than the core.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/bus/core/crossbar.h"
#include "model/cpu/core/debug_control.h"
#include "model/mem/core/ddr_controller.h"

namespace fovea::app {

/// Observes the crossbar while a debugger may attach. Does not influence it.
class GdbMasters final : public MemObserver {
 public:
  using Kind = cpu::CoreControl::Watch;
  /// A watched range: bytes from the physical address `pa` on; the debugger knows the first one as
  /// `va`.
  struct Watch {
    std::uint32_t pa = 0, bytes = 0, va = 0;
    Kind kind = Kind::kWrite;
    std::optional<Master> only;  ///< empty: any master except the core
    bool packet = false;         ///< set by a Z packet, not by `monitor watch dma`
    friend bool operator==(const Watch&, const Watch&) = default;
  };
  struct Hit {
    Picoseconds at = 0;  ///< time of a write's acknowledgement, or of a read's last beat
    Master master = Master::kVpfe;
    bool write = false;
    std::uint32_t va = 0, pa = 0;  ///< first watched byte that was accessed
    std::uint32_t bytes = 0;       ///< number of watched bytes that were accessed
    Watch watch;
  };

  /// @param ddr_base address of the SDRAM on the crossbar
  GdbMasters(bus::Crossbar& crossbar, const mem::DdrController& ddr, std::uint32_t ddr_base);
  GdbMasters(const GdbMasters&) = delete;
  GdbMasters& operator=(const GdbMasters&) = delete;

  /// Called for each access to watched bytes as soon as its time is known, which may be in the
  /// future.
  std::function<void(const Hit&)> on_hit;
  std::vector<Watch> watches;

  /// Describes the outstanding requests of each master at `now`, oldest first, and the SDRAM queue.
  /// The caller must have advanced the bus to `now`.
  std::string where(Picoseconds now) const;

 private:
  struct Request {
    const MemRequest* request;  // must not be read once decided: its master may have reused it
    std::uint32_t address;
    std::uint8_t bytes;
    bool write, to_sdram, decided;
    Picoseconds issued, first, last;
  };
  void submitted(const MemRequest& r, bool to_sdram) override;
  void responded(const MemRequest& r) override { done(r); }
  void register_done(const MemRequest& r) override { done(r); }
  void done(const MemRequest& r);
  void check_watches(const MemRequest& r) const;
  std::string position_text(const Request& r, const bus::Crossbar::View& bus,
                    const mem::DdrController::View& ddr, Picoseconds now) const;
  std::string in_crossbar(const bus::Crossbar::View::Item& item, const MemRequest& r,
                          const bus::Crossbar::View& bus, Picoseconds now) const;
  std::string in_controller(const mem::DdrController::View& ddr, std::size_t item,
                            Picoseconds now) const;

  bus::Crossbar& crossbar_;
  const mem::DdrController& ddr_;
  std::uint32_t ddr_base_;
  Subscription observing_;
  std::array<std::vector<Request>, kMasterCount> under_way_;
};

}  // namespace fovea::app
