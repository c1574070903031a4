#pragma once
/// Child processes and folders of tests.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace noctule::system_test {

namespace fs = std::filesystem;

[[nodiscard]] inline std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A new empty folder that is gone after the test.
class Folder {
 public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "noctule_system_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] fs::path operator/(const std::string& name) const { return path_ / name; }

 private:
  fs::path path_;
};

struct Outcome {
  int exit_code = -1;  ///< minus the signal that ended it
  std::string output;  ///< of the terminal, both streams
  double cpu_seconds = 0.0;
};

/// A program that runs beside the test, and that is killed with it.
class Process {
 public:
  explicit Process(const std::vector<std::string>& arguments) {
    std::string pattern = (fs::temp_directory_path() / "noctule_output_XXXXXX").string();
    const int output = mkstemp(pattern.data());
    output_ = pattern;
    pid_ = fork();
    if (pid_ == 0) {
      dup2(output, STDOUT_FILENO);
      dup2(output, STDERR_FILENO);
      std::vector<char*> argv;
      for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
      argv.push_back(nullptr);
      execvp(argv[0], argv.data());
      _exit(127);
    }
    close(output);
  }
  ~Process() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    std::error_code ignored;
    fs::remove(output_, ignored);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void send(int signal) const { kill(pid_, signal); }
  [[nodiscard]] std::string output() const { return read_file(output_); }

  /// Waits until the program has printed `text`, for at most 30 s.
  [[nodiscard]] bool says(const std::string& text) const {
    for (int i = 0; i < 3000; ++i) {
      if (output().find(text) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

  [[nodiscard]] Outcome wait() {
    int status = 0;
    rusage usage{};
    wait4(pid_, &status, 0, &usage);
    pid_ = -1;
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), output(),
            seconds(usage.ru_utime) + seconds(usage.ru_stime)};
  }

 private:
  pid_t pid_ = -1;
  fs::path output_;
};

[[nodiscard]] inline Outcome run(const std::vector<std::string>& arguments) {
  return Process(arguments).wait();
}

}  // namespace noctule::system_test
