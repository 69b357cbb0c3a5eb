// Work in a process of its own: a simulation elaborates once in each.
#pragma once
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <functional>
#include <string>

namespace fovea::test {

struct ChildSays {
  bool ok = false;  ///< it ended without an exception, and all of its text has come
  std::string text;
};

/// What `work` returns in a child process.
inline ChildSays child_says(const std::function<std::string()>& work) {
  int ends[2];
  if (::pipe(ends) != 0) return {};
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    std::string all;
    try {
      all = work();
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s\n", e.what());
      ::_exit(1);
    }
    for (std::size_t at = 0; at < all.size();) {
      const ssize_t n = ::write(ends[1], all.data() + at, all.size() - at);
      if (n <= 0) ::_exit(1);
      at += static_cast<std::size_t>(n);
    }
    ::_exit(0);
  }
  ::close(ends[1]);
  ChildSays out;
  char chunk[65536];
  for (ssize_t n; (n = ::read(ends[0], chunk, sizeof chunk)) > 0;) out.text.append(chunk, static_cast<std::size_t>(n));
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  out.ok = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  return out;
}

/// The same where the child has to succeed.
inline std::string in_child(const std::function<std::string()>& work) {
  const ChildSays said = child_says(work);
  EXPECT_TRUE(said.ok) << "the child process failed";
  return said.text;
}

}  // namespace fovea::test
