// One run in a process of its own (a second elaboration in one process fails), with or without a planted
// error of the horizon.
#pragma once
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <functional>
#include <string>

#include "tb/sync/late_horizon.h"

namespace fovea::sync {

/// What `run` returns, in a process in which every horizon is `late` by so much; empty if it failed. The
/// only place that plants the error.
inline std::string in_child(Picoseconds late, const std::function<std::string()>& run) {
  int fd[2];
  if (pipe(fd) != 0) return {};
  const pid_t pid = fork();
  if (pid == 0) {
    close(fd[0]);
    std::string all;
    try {
      planted_late_horizon = late;
      all = run();
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s\n", e.what());
      _exit(1);
    }
    for (std::size_t at = 0; at < all.size();) {
      const ssize_t n = write(fd[1], all.data() + at, all.size() - at);
      if (n <= 0) _exit(1);
      at += static_cast<std::size_t>(n);
    }
    _exit(0);
  }
  close(fd[1]);
  std::string all;
  char buffer[65536];
  for (ssize_t n; (n = read(fd[0], buffer, sizeof buffer)) > 0;)
    all.append(buffer, static_cast<std::size_t>(n));
  close(fd[0]);
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? all : "";
}

/// The first line in which two records differ; empty if they are equal.
inline std::string first_difference(const std::string& strict, const std::string& fast) {
  for (std::size_t line = 0; line < strict.size() && line < fast.size();) {
    const std::size_t es = strict.find('\n', line), ef = fast.find('\n', line);
    if (strict.substr(line, es - line) != fast.substr(line, ef - line))
      return "strict:  " + strict.substr(line, es - line) + "\ndefault: " + fast.substr(line, ef - line);
    line = es + 1;
  }
  return strict.size() == fast.size() ? "" : "one record is longer";
}

}  // namespace fovea::sync
