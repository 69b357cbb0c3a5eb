#include "sw/fovea/points/point_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/output_file.h"
#include "sw/fovea/files/output_folder.h"
#include "sw/fovea/files/safe_json.h"

namespace fovea::points {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::string_view kMarker = "{\"format\": \"fovea points 1\"}\n";
constexpr std::size_t kMaxBytes = 1u << 20;

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
  throw UserError(fmt::format("folder of points '{}': {}", app::one_line(path.string()), why));
}

/// Opens a folder of the own user. @throws UserError
int open_own(int at, const std::string& name, const fs::path& shown, int flags) {
  const int fd = ::openat(at, name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | flags);
  if (fd < 0) fail(shown, errno == ENOTDIR ? "it is not a folder" : std::strerror(errno));
  struct stat info {};
  const bool known = ::fstat(fd, &info) == 0;
  if (known && info.st_uid == ::geteuid()) return fd;
  ::close(fd);
  fail(shown, "it belongs to another user; choose another name");
}

/// True if the folder holds nothing, or no more than a process that ended before its marker was whole.
bool has_no_files(const fs::path& dir) {
  for (const auto& entry : fs::directory_iterator(dir)) {
    const fs::path name = entry.path().filename();
    if (name != "points.json.tmp" && !(name == "points" && entry.is_directory() && fs::is_empty(entry.path())))
      return false;
  }
  return true;
}

void remove_whole(const fs::path& name) {
  std::error_code error;
  fs::remove_all(name, error);
  if (error) fail(name, error.message());
}

}  // namespace

PointStore::PointStore(const fs::path& dir) : dir_(dir) {
  if (dir.empty()) fail(dir, "a name is needed");
  std::error_code error;
  if (!fs::exists(dir)) fs::create_directories(dir, error);
  if (error) fail(dir, error.message());
  lock_ = open_own(AT_FDCWD, dir.string(), dir, 0);
  try {
    open();
  } catch (...) {
    if (points_ >= 0) ::close(points_);
    ::close(lock_);
    throw;
  }
}

void PointStore::open() {
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) fail(dir_, "another program is running points in it now");
  const fs::path marker = dir_ / "points.json";
  const bool there = fs::exists(fs::symlink_status(marker));
  if (there ? app::read_file(marker, kMaxBytes) != kMarker : !has_no_files(dir_))
    fail(dir_, "it holds something else than points of Fovea; choose another name");
  if (!there) write("points.json", kMarker);
  if (::mkdirat(lock_, "points", 0777) != 0 && errno != EEXIST) fail(dir_ / "points", std::strerror(errno));
  points_ = open_own(lock_, "points", dir_ / "points", O_NOFOLLOW);
}

PointStore::~PointStore() {
  ::close(points_);
  ::close(lock_);
}

void PointStore::write(std::string_view name, std::string_view text) { app::replace_file(lock_, dir_ / name, text); }

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
  fs::path name = working(key);
  remove_whole(name);
  if (::mkdirat(points_, name.filename().c_str(), 0777) != 0) fail(name, std::strerror(errno));
  return name;
}

void PointStore::finish(PointResult& result, const std::vector<std::string>& command) {
  const fs::path name = working(result.key);
  const json entry = {{"format", "fovea point 1"}, {"key", result.key},
                      {"command", command},        {"status", result.status},
                      {"message", result.message}, {"wall_time", result.wall_seconds}};
  app::CheckedFile file(name / "point.json", app::CheckedFile::New{});
  file.write(entry.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
  file.sync();
  file.close();
  for (const char* part : {"output.txt", "messages.txt", ""}) app::sync_to_disk(name / part);
  result.folder = folder(result.key);
  if (::renameat(points_, name.filename().c_str(), points_, result.folder.filename().c_str()) != 0)
    fail(result.folder, std::strerror(errno));
  app::sync_to_disk(dir_ / "points");
  read_stats(result);
}

void PointStore::abandon(std::string_view key) {
  std::error_code ignored;
  fs::remove_all(working(key), ignored);
}

/// It becomes an unfinished one first: what a crash leaves of it is no result.
void PointStore::forget(std::string_view key) {
  const fs::path name = working(key), whole = folder(key);
  remove_whole(name);
  if (::renameat(points_, whole.filename().c_str(), points_, name.filename().c_str()) != 0)
    fail(whole, std::strerror(errno));
  remove_whole(name);
}

}  // namespace fovea::points
