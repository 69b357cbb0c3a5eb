#include "sw/fovea/points/point_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "model/common/check.h"
#include "sw/fovea/checked_file.h"
#include "sw/fovea/safe_json.h"

namespace fovea::points {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::string_view kMarker = "{\"format\": \"fovea points 1\"}\n";
constexpr std::size_t kMaxBytes = 1u << 20;

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
  throw UserError(fmt::format("folder of points '{}': {}", app::one_line(path.string()), why));
}

}  // namespace

PointStore::PointStore(const fs::path& dir) : dir_(dir) {
  if (dir.empty()) fail(dir, "a name is needed");
  const fs::path marker = dir / "points.json";
  std::error_code error;
  const fs::file_status there = fs::status(dir, error);
  if (fs::exists(there)) {
    if (!fs::is_directory(there)) fail(dir, "it is not a folder");
    if (fs::exists(marker) ? app::read_file(marker, kMaxBytes) != kMarker : !fs::is_empty(dir))
      fail(dir, "it holds something else than points of Fovea; choose another name");
  }
  fs::create_directories(dir / "points", error);
  if (error) fail(dir, error.message());
  lock_ = ::open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) fail(dir, std::strerror(errno));
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_);
    fail(dir, "another program is running points in it now");
  }
  if (!fs::exists(marker)) app::write_file(marker, kMarker);
}

PointStore::~PointStore() { ::close(lock_); }

fs::path PointStore::folder(std::string_view key) const {
  return dir_ / "points" / folder_name(key);
}

fs::path PointStore::working(std::string_view key) const {
  fs::path name = folder(key);
  name += ".tmp";
  return name;
}

std::optional<PointResult> PointStore::find(std::string_view key) const {
  PointResult result;
  result.folder = folder(key);
  if (!fs::exists(result.folder)) return std::nullopt;
  const json entry = app::read_json(result.folder / "point.json");
  if (!entry.is_object() || !entry.contains("key") || entry["key"] != key ||
      !entry.contains("status") || !entry["status"].is_number_integer() ||
      (entry.contains("message") && !entry["message"].is_string()) ||
      (entry.contains("wall_time") && !entry["wall_time"].is_number()))
    fail(result.folder, "its point.json is not that of this point; remove it to run the point again");
  result.key = key;
  result.status = entry["status"];
  result.message = entry.value("message", std::string());
  result.wall_seconds = entry.value("wall_time", 0.0);
  result.reused = true;
  read_stats(result);
  return result;
}

fs::path PointStore::begin(std::string_view key) {
  const fs::path name = working(key);
  std::error_code error;
  fs::remove_all(name, error);
  if (error) fail(name, error.message());
  fs::create_directory(name, error);
  if (error) fail(name, error.message());
  return name;
}

void PointStore::finish(PointResult& result, const std::vector<std::string>& command) {
  const fs::path name = working(result.key);
  const json entry = {{"format", "fovea point 1"}, {"key", result.key},
                      {"command", command},        {"status", result.status},
                      {"message", result.message}, {"wall_time", result.wall_seconds}};
  app::CheckedFile file(name / "point.json");
  file.write(entry.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
  file.sync();
  file.close();
  result.folder = folder(result.key);
  std::error_code error;
  fs::rename(name, result.folder, error);
  if (error) fail(result.folder, error.message());
  read_stats(result);
}

void PointStore::abandon(std::string_view key) {
  std::error_code ignored;
  fs::remove_all(working(key), ignored);
}

void PointStore::forget(std::string_view key) {
  std::error_code error;
  fs::remove_all(folder(key), error);
  if (error) fail(folder(key), error.message());
}

}  // namespace fovea::points
