#include "tb/e2e/views_rig.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "model/contract/view_page.h"
#include "sw/fovea/board/loader.h"
#include "sw/fovea/board/parameter_page.h"
#include "sw/fovea/config/calibration.h"
#include "sw/fovea/config/experiment.h"
#include "tb/e2e/geometry.h"
#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

constexpr unsigned kCameras = 4;

oracle::Frame woven(const video::Picture& even, const video::Picture& odd, unsigned w, unsigned h) {
  const unsigned x = (even.width - w) / 2, y = (even.height - h) / 2;
  oracle::Frame f = crop(even, x, y, w, h);
  const oracle::Frame second = crop(odd, x, y, w, h);
  for (unsigned r = (y + 1) % 2; r < h; r += 2)
    std::memcpy(f.uyvy.data() + std::size_t{r} * w * 2, second.uyvy.data() + std::size_t{r} * w * 2,
                std::size_t{w} * 2);
  return f;
}

}  // namespace

ViewsRig::ViewsRig()
    : elf_(app::ElfImage::load(std::filesystem::path(FOVEA_FIRMWARE_DIR) / "fovea_views.elf")) {
  params.declare(set_);
}

ViewsRig::~ViewsRig() = default;

ViewsRig& ViewsRig::set(const std::string& key, const std::string& value) {
  set_.set(key, value);
  return *this;
}

ViewsRig& ViewsRig::load(const std::string& name) {
  app::Experiment experiment(set_);
  experiment.load(std::filesystem::path(FOVEA_EXPERIMENTS_DIR) / name);
  app::apply_calibrations(set_, experiment);
  return *this;
}

board::Board& ViewsRig::build() {
  app::check_fits(elf_, app::memory_regions(params));
  app::complete_params(params);
  std::vector<video::PictureSource*> pictures, references;
  std::vector<const video::StampedSource*> stamped;
  views_.birds_eye = params.firmware.view.is("birds_eye");
  views_.quad = params.cameras.quad();
  views_.ground_width = params.birds_eye.width();
  views_.ground_height = params.birds_eye.height();
  views_.car_length = params.birds_eye.car_length();
  views_.car_width = params.birds_eye.car_width();
  for (unsigned n = 0; n < kCameras; ++n) {
    sources_.push_back(app::camera_source(params, n));
    references_.push_back(app::camera_source(params, n));
    pictures.push_back(sources_.back().get());
    references.push_back(references_.back().get());
    stamped.push_back(sources_.back().get());
    views_.lens[n] = geometry_of(params, *params.camera_setup(n).lens);
    const board::MountParams& m = params.mounts[n];
    views_.mount[n] = {m.x(), m.y(), m.height(), m.yaw(), m.pitch(), m.roll()};
  }
  cameras_ = oracle::cameras_of(views_);
  if (views_.quad) {
    quad_ = std::make_unique<video::QuadSource>(std::array{pictures[0], pictures[1], pictures[2], pictures[3]});
    quad_reference_ =
        std::make_unique<video::QuadSource>(std::array{references[0], references[1], references[2], references[3]});
    pictures = {quad_.get()};
  }
  board_ = std::make_unique<board::Board>("board", params, pictures, elf_.entry(), false);
  for (const auto& s : elf_.segments()) board_->load({s.address, s.data, s.memory_size - s.data.size()});
  board_->load({PARAM_PAGE_BASE, app::parameter_page(params, stamped)});
  frames_ = board_->observe_frames([this](const video::Frame& f) {
    if (keep && !keep(f.times)) return;
    const unsigned w = params.width(), h = params.height();
    shown_.push_back({crop(f.picture, (f.picture.width - w) / 2, (f.picture.height - h) / 2, w, h), f.times.index,
                      f.times.display_start, {}});
  });
  return *board_;
}

void ViewsRig::run(Picoseconds limit) {
  if (!board_) build();
  while (!board_->window_end() && board_->dm365.arm.failure().empty() && kernel_time() < limit)
    slicer_.run(kPsPerMs);
}

ViewsRig::Runs ViewsRig::runs() const {
  // `view` and `run_t` of sw/firmware/app/composition.c, as the target's compiler lays them out.
  struct View {
    std::uint32_t config, alignment;
    view_page_t page;
    std::uint32_t pairs, rows, run, runs;
    std::array<std::uint32_t, 4> first_run;
  };
  struct Run {
    std::uint32_t out, first;
    std::uint16_t camera, pairs;
  };
  View view{};
  const auto bytes = board_->peek(elf_.find("view")->address, sizeof view);
  std::memcpy(&view, bytes.data(), sizeof view);
  std::vector<Run> list(view.runs);
  const auto entries = board_->peek(view.run, list.size() * sizeof(Run));
  std::memcpy(list.data(), entries.data(), entries.size());
  Runs out;
  out.first = view.first_run;
  for (const Run& r : list) out.camera.push_back(r.camera);
  return out;
}

std::vector<std::uint32_t> ViewsRig::table() const {
  const auto* symbol = elf_.find("lut");
  std::vector<std::uint32_t> out(std::size_t{params.width()} / 2 * params.height());
  const auto bytes = board_->peek(symbol->address, out.size() * 4);
  std::memcpy(out.data(), bytes.data(), bytes.size());
  return out;
}

const oracle::Frame& ViewsRig::sent(unsigned camera, std::uint64_t number) {
  if (views_.quad) camera = 0;
  oracle::Frame& frame = sent_[{camera, number}];
  if (frame.uyvy.empty()) {
    video::PictureSource& source =
        views_.quad ? static_cast<video::PictureSource&>(*quad_reference_) : *references_[camera];
    const video::Picture even = source.field(2 * number);
    frame = woven(even, source.field(2 * number + 1), params.width(), params.height());
  }
  return frame;
}

std::string ViewsRig::find_frames(Composed& shown, const std::vector<std::uint32_t>& lut,
                                  std::uint64_t oldest) {
  const std::uint32_t pitch = views_.lens[0].pitch_bytes, black = params.height() * pitch;
  const auto pair_of = [&](const oracle::Frame& f, std::size_t at) {
    std::uint32_t word = 0;
    std::memcpy(&word, f.uyvy.data() + at, 4);
    return word;
  };
  const auto newest = static_cast<std::uint64_t>(shown.start / (40 * kPsPerMs));
  for (unsigned n = 0; n < kCameras; ++n) {
    // Without a lens in sight (all of it black) a part says nothing.
    std::vector<std::pair<std::size_t, std::size_t>> places;  // displayed byte, sent byte
    for (std::size_t i = 0; i < lut.size(); ++i)
      if (cameras_[i] == static_cast<int>(n) && lut[i] != black)
        places.emplace_back(i * 4, std::size_t{lut[i] / pitch} * params.width() * 2 + lut[i] % pitch);
    if (places.empty()) return "camera " + std::to_string(n) + " is not in the picture";
    const auto shows = [&](const oracle::Frame& f) {
      return std::all_of(places.begin(), places.end(), [&](const auto& p) {
        return pair_of(shown.frame, p.first) == pair_of(f, p.second);
      });
    };
    unsigned fits = 0;
    for (std::uint64_t k = newest > oldest ? newest - oldest : 0; k <= newest; ++k)
      if (shows(sent(n, k))) {
        shown.number[n] = k;
        ++fits;
      }
    if (fits > 1) return "several frames of camera " + std::to_string(n) + " look the same";
  }
  return "";
}

std::optional<SourcePixel> ViewsRig::source_pixel(unsigned camera, unsigned u, unsigned v) const {
  // A camera in the bird's-eye view may be turned by any angle: of a pair only the pixel for which it was looked up is
  // in its place.
  const bool by_centre = views_.lens[0].method == oracle::PairMethod::kPairCentre;
  const oracle::Shown s = oracle::shown_at(views_, views_.birds_eye ? u / 2 * 2 + (by_centre ? 0.5 : 0) : u, v);
  if (s.camera != static_cast<int>(camera)) return std::nullopt;
  const double x = (params.raster_width() - params.width()) / 2, y = (params.raster_height() - params.height()) / 2;
  const double column = std::floor(s.at.x + 0.5), row = std::floor(s.at.y + 0.5) + y;
  const auto in_pair = [&](double of) { return std::floor(of / 2) * 2 + u % 2; };
  if (!views_.quad)
    return SourcePixel{{(views_.birds_eye ? in_pair(column) : column) + x, row}, std::fmod(row, 2) != 0};
  // A pixel of the quad's picture is the mean of two by two of the camera's, all of one field.
  const double half_row = std::floor(row / 2), half = std::floor(column / 2);
  return SourcePixel{{2 * (views_.birds_eye ? in_pair(half) : half) + 0.5, 2 * half_row + 0.5},
                     std::fmod(half_row, 2) != 0};
}

std::optional<std::uint64_t> ViewsRig::stamp(const Composed& shown, unsigned camera) const {
  const auto& layout = sources_[camera]->stamps();
  if (!layout) return std::nullopt;
  const auto f = read_frame(shown.frame, *layout,
                            [&](unsigned u, unsigned v) { return source_pixel(camera, u, v); });
  if (!f || f->camera != camera) return std::nullopt;
  return f->number;
}

std::string ViewsRig::wrong_composition(const Composed& s, const std::vector<std::uint32_t>& lut) {
  std::array<const oracle::Frame*, kCameras> frames{};
  bool any = false;
  for (unsigned n = 0; n < kCameras; ++n)
    if (s.number[n]) {
      frames[n] = &sent(n, *s.number[n]);
      any = true;
    }
  if (!any) return "no part is that of a sent frame";
  const auto d = oracle::compare(oracle::compose(frames, lut, cameras_, views_.lens[0].pitch_bytes), s.frame);
  return d ? d->text() : "";
}

std::string ViewsRig::wrong_by_stamps(const std::vector<std::uint32_t>& lut) {
  for (Composed& s : shown_) {
    for (unsigned n = 0; n < kCameras; ++n) s.number[n] = stamp(s, n);
    if (const std::string fault = wrong_composition(s, lut); !fault.empty())
      return "displayed frame " + std::to_string(s.index) + ": " + fault;
  }
  return "";
}

std::string ViewsRig::wrong_picture(const std::vector<std::uint32_t>& lut, std::uint64_t oldest) {
  for (Composed& s : shown_) {
    const std::string which = "displayed frame " + std::to_string(s.index) + ": ";
    s.number = {};
    if (const std::string fault = find_frames(s, lut, oldest); !fault.empty()) return which + fault;
    if (const std::string fault = wrong_composition(s, lut); !fault.empty()) return which + fault;
  }
  return "";
}

}  // namespace fovea::e2e
