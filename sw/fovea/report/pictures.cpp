#include "sw/fovea/report/pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/png.h"
#include "sw/fovea/report/html.h"

namespace fovea::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxPngBytes = 256u << 20;
constexpr int kPngLevel = 6;

/// PNG files of a folder by the number at the end of their names; the first name of a number wins.
std::map<std::uint64_t, fs::path> numbered(const fs::path& folder) {
  std::vector<fs::path> names;
  std::error_code error;
  for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error))
    if (i->path().extension() == ".png" && i->is_regular_file(error)) names.push_back(i->path());
  std::sort(names.begin(), names.end());
  std::map<std::uint64_t, fs::path> out;
  for (const auto& name : names) {
    const std::string stem = name.stem().string();
    const auto last = stem.find_last_not_of("0123456789");
    const std::string digits = stem.substr(last == stem.npos ? 0 : last + 1);
    if (!digits.empty() && digits.size() <= 18) out.emplace(std::stoull(digits), name);
  }
  return out;
}

/// Files of a run's pictures.
struct Files {
  std::optional<std::uint64_t> frame;
  fs::path before, after;
  struct Camera {
    unsigned camera = 0;
    std::uint64_t frame = 0;
    fs::path file;
  };
  std::vector<Camera> cameras;
};

bool composed(const Results& run) {
  const auto* view = run.parameter("firmware.view");
  return view && view->value != "single";
}

Files choose(const Results& run) {
  const auto camera = numbered(run.folder / "camera"), shown = numbered(run.folder / "frames");
  if (composed(run) && run.frames && !shown.empty()) {
    Files out{.frame = shown.rbegin()->first, .before = {}, .after = shown.rbegin()->second, .cameras = {}};
    std::map<unsigned, std::uint64_t> last;  // frame by camera
    for (const auto& row : *run.frames)
      if (row.index <= out.frame && camera.contains(row.index)) last[row.camera] = row.index;
    for (const auto& [n, frame] : last) out.cameras.push_back({n, frame, camera.at(frame)});
    if (!out.cameras.empty()) return out;
  }
  for (const auto& [n, after] : shown)
    if (const auto found = camera.find(n); found != camera.end()) return {n, found->second, after, {}};
  if (!shown.empty()) return {shown.begin()->first, {}, shown.begin()->second, {}};
  return {};
}

std::vector<std::uint8_t> bytes_of(const fs::path& file) {
  const std::string text = app::read_file(file, kMaxPngBytes);
  return {text.begin(), text.end()};
}

Picture embed(const fs::path& file, const app::RgbImage& image, unsigned factor) {
  const auto bytes =
      factor == 1 ? bytes_of(file) : app::encode_png(shrink(image, factor), kPngLevel);
  return {"data:image/png;base64," + base64(bytes), image.width, image.height, factor};
}

}  // namespace

app::RgbImage shrink(const app::RgbImage& image, unsigned factor) {
  app::RgbImage out{.width = image.width / factor, .height = image.height / factor, .rgb = {}};
  out.rgb.reserve(std::size_t{3} * out.width * out.height);
  const unsigned n = factor * factor;
  for (unsigned y = 0; y < out.height; ++y)
    for (unsigned x = 0; x < out.width; ++x)
      for (unsigned c = 0; c < 3; ++c) {
        unsigned sum = n / 2;
        for (unsigned k = 0; k < n; ++k) {
          const std::size_t row = y * factor + k / factor, column = x * factor + k % factor;
          sum += image.rgb[3 * (row * image.width + column) + c];
        }
        out.rgb.push_back(static_cast<std::uint8_t>(sum / n));
      }
  return out;
}

std::optional<PictureDifference> difference(const app::RgbImage& a, const app::RgbImage& b) {
  if (a.width != b.width || a.height != b.height || a.rgb.empty()) return std::nullopt;
  PictureDifference out;
  out.all = a.rgb.size() / 3;
  double squares = 0;
  for (std::size_t i = 0; i < a.rgb.size(); i += 3) {
    bool differs = false;
    for (std::size_t c = i; c < i + 3; ++c) {
      const double d = static_cast<double>(a.rgb[c]) - b.rgb[c];
      squares += d * d;
      differs |= d != 0;
    }
    out.pixels += differs;
  }
  out.psnr = squares == 0
                 ? std::numeric_limits<double>::infinity()
                 : 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.rgb.size()) / squares);
  return out;
}

std::vector<RunPictures> choose_pictures(const std::vector<Results>& runs, std::size_t budget) {
  struct Loaded {
    Files files;
    std::optional<app::RgbImage> before, after;
    std::vector<app::RgbImage> cameras;
  };
  std::vector<Loaded> loaded;
  std::size_t pictures = 0;
  for (const auto& run : runs) {
    Loaded one{choose(run), {}, {}, {}};
    if (!one.files.before.empty()) one.before = app::read_png(one.files.before);
    if (!one.files.after.empty()) one.after = app::read_png(one.files.after);
    for (const auto& c : one.files.cameras) one.cameras.push_back(app::read_png(c.file));
    pictures += one.before.has_value() + one.after.has_value() + one.cameras.size();
    loaded.push_back(std::move(one));
  }
  std::vector<RunPictures> out;
  for (const auto& one : loaded) {
    RunPictures chosen;
    chosen.frame = one.files.frame;
    // An equal share for each picture; a factor of 2 leaves about a quarter of the bytes.
    const auto fit = [&](const fs::path& file, const app::RgbImage& image) {
      Picture picture;
      for (unsigned factor = 1;; factor *= 2) {
        picture = embed(file, image, factor);
        if (picture.uri.size() <= budget / pictures || image.width < 4 * factor ||
            image.height < 4 * factor)
          return picture;
      }
    };
    if (one.before) chosen.before = fit(one.files.before, *one.before);
    if (one.after) chosen.after = fit(one.files.after, *one.after);
    for (std::size_t c = 0; c < one.cameras.size(); ++c) {
      const auto& files = one.files.cameras[c];
      chosen.cameras.push_back({files.camera, files.frame, fit(files.file, one.cameras[c])});
    }
    if (&one != &loaded.front() && one.after && loaded.front().after &&
        one.files.frame == loaded.front().files.frame)
      chosen.from_first = difference(*loaded.front().after, *one.after);
    out.push_back(std::move(chosen));
  }
  return out;
}

}  // namespace fovea::report
