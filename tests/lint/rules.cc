#include "tests/lint/rules.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <regex>
#include <set>

#include "tests/lint/folder_table.h"

namespace handrail::lint {
namespace {

// What a folder's library is called in CMake.
std::string target_of(const std::string& folder) {
  if (folder == "devices") return "registry";
  if (folder == "proto") return folder;
  if (folder == "client/cli") return "cli";
  if (starts_with(folder, "client/cli/")) return "cli_" + folder.substr(11);
  std::string name = starts_with(folder, "client/") ? folder : folder.substr(folder.find('/') + 1);
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

bool is_project_path(const std::string& path) {
  for (const char* top : {"proto/", "server/", "devices/", "client/", "tests/"}) {
    if (starts_with(path, top)) return true;
  }
  return false;
}

bool is_test(const std::string& path) { return starts_with(path, "tests/"); }

std::string stem_of(const std::string& path) {
  const std::string name = path.substr(path.rfind('/') + 1);
  return name.substr(0, name.find('.'));
}

// Files of the simulation and of scenes that may see generated protobuf headers: the readers of
// text files, the check of field ranges they share, and mains.
bool reads_text(const std::string& stem) {
  return ends_with(stem, "_io") || ends_with(stem, "_main") || stem == "field_check";
}

// Plain data and steps; what is inside such a folder is as pure.
constexpr const char* kPure[] = {"server/model",   "server/kinematics", "server/constraint",
                                 "server/effects", "server/task",       "server/session",
                                 "server/haptic",  "server/motion",     "server/follow"};

Violations forbid(const File& source, const std::vector<std::string>& starts,
                  const std::string& why) {
  Violations found;
  for (const std::string& include : includes_of(source.text)) {
    for (const std::string& start : starts) {
      if (starts_with(include, start)) {
        found.push_back(source.path + ": includes " + include + ", but " + why);
      }
    }
  }
  return found;
}

}  // namespace

std::string folder_of(const std::string& path) {
  const std::size_t slash = starts_with(path, "proto/") ? path.find('/') : path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash);
}

bool is_in_table(const std::string& folder) { return folder_table().count(folder) != 0; }

bool may_use(const std::string& path, const std::string& folder) {
  const std::string own = folder_of(path);
  if (own == folder) return true;
  const auto row = folder_table().find(own);
  return row != folder_table().end() && row->second.count(folder) != 0;
}

Violations include_direction(const File& source) {
  const std::string own = folder_of(source.path);
  if (!is_in_table(own)) return {source.path + ": folder " + own + " has no row in the table"};
  Violations found;
  for (const std::string& include : includes_of(source.text)) {
    if (!is_project_path(include)) continue;
    const std::string folder = folder_of(include);
    const bool io_only =
        folder == "proto" && (own == "server/scene" || starts_with(own, "devices/rig"));
    if (!may_use(source.path, folder)) {
      found.push_back(source.path + ": " + own + " may not include " + include);
    } else if (io_only && !reads_text(stem_of(source.path))) {
      found.push_back(source.path + ": only *_io files here may include " + include);
    }
  }
  return found;
}

Violations link_direction(const File& cmake) {
  static const std::regex call(R"(handrail_library\(\s*(\w+)([^)]*)\))");
  static const std::regex target(R"(handrail_(\w+))");
  const std::string text = cmake_only(cmake.text);
  Violations found;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), call); it != std::sregex_iterator();
       ++it) {
    const std::string targets = (*it)[2];
    for (auto dep = std::sregex_iterator(targets.begin(), targets.end(), target);
         dep != std::sregex_iterator(); ++dep) {
      const std::string name = (*dep)[1];
      const bool allowed =
          name == "options" || target_of(folder_of(cmake.path)) == name ||
          std::any_of(folder_table().begin(), folder_table().end(), [&](const auto& row) {
            return target_of(row.first) == name && may_use(cmake.path, row.first);
          });
      if (!allowed) found.push_back(cmake.path + ": may not link handrail_" + name);
    }
  }
  return found;
}

Violations base_dependencies(const File& source) {
  if (folder_of(source.path) != "server/base") return {};
  return forbid(source, {"boost/", "spdlog/", "google/", "CLI/", "gtest/", "benchmark/"},
                "base depends on the standard library and Eigen only");
}

Violations pure_folders(const File& source) {
  const std::string folder = folder_of(source.path);
  const bool pure = std::any_of(std::begin(kPure), std::end(kPure), [&](const char* room) {
    return folder == room || starts_with(folder, room + std::string("/"));
  });
  if (!pure) return {};
  return forbid(
      source,
      {"chrono", "ctime", "time.h", "thread", "mutex", "shared_mutex", "condition_variable",
       "future", "semaphore", "iostream", "fstream", "sstream", "spdlog", "boost/", "sys/",
       "server/base/clock.h", "server/base/pacer.h", "server/base/realtime.h"},
      "steps are pure: no clock, thread, lock, stream, log or socket");
}

Violations logging(const File& source) {
  if (is_test(source.path)) return {};
  const std::string folder = folder_of(source.path);
  const bool speaks = starts_with(folder, "devices") || starts_with(folder, "client") ||
                      folder == "server/master" || folder == "server/slave" ||
                      folder == "server/daemon" || starts_with(folder, "server/lab");
  // Turned by the haptic and the robot thread.
  const bool in_real_time = ends_with(source.path, "_loop.cc") ||
                            starts_with(folder, "devices/melfa") ||
                            starts_with(folder, "devices/hand");
  if (speaks && ends_with(source.path, ".cc") && !in_real_time) return {};
  return forbid(source, {in_real_time ? "spdlog/spdlog.h" : "spdlog/"},
                "logs are written by .cc files of daemons, client and devices, and by no loop");
}

Violations networking(const File& source) {
  const std::string folder = folder_of(source.path), stem = stem_of(source.path);
  if (is_test(source.path) || folder == "devices/udp" || starts_with(folder, "client/")) return {};
  for (const char* role :
       {"_main", "_transport", "_server", "_socket", "_resolver", "_sink", "_robot", "_sensor"}) {
    if (ends_with(stem, role)) return {};
  }
  return forbid(source, {"boost/asio", "boost/beast", "sys/socket.h", "netinet/"},
                "sockets stay in *_transport, *_server, *_socket, *_resolver, *_sink, *_robot, "
                "*_sensor and *_main");
}

Violations heavy_headers(const std::vector<File>& sources) {
  Violations found;
  for (const std::string heavy : {"boost/beast", "CLI/"}) {
    std::set<std::string> users;
    for (const File& source : sources) {
      for (const std::string& include : includes_of(source.text)) {
        if (starts_with(include, heavy)) users.insert(source.path);
      }
    }
    if (users.size() <= 2) continue;
    std::string list;
    for (const std::string& user : users) list += " " + user;
    found.push_back(heavy + " is included by more than two files:" + list);
  }
  return found;
}

Violations file_size(const File& source) {
  constexpr std::ptrdiff_t kMost = 400;
  const std::ptrdiff_t lines = std::count(source.text.begin(), source.text.end(), '\n');
  if (lines <= kMost) return {};
  return {source.path + ": " + std::to_string(lines) + " lines, split at " + std::to_string(kMost)};
}

Violations folder_size(const std::vector<File>& files) {
  constexpr int kMost = 40;
  std::map<std::string, int> counts;
  for (const File& file : files) ++counts[folder_of(file.path)];
  Violations found;
  for (const auto& [folder, count] : counts) {
    const std::string files_text = std::to_string(count) + " files, split at ";
    if (count > kMost) found.push_back(folder + ": " + files_text + std::to_string(kMost));
  }
  return found;
}

Violations build_options(const File& cmake) {
  const std::string text = ends_with(cmake.path, ".json") ? cmake.text : cmake_only(cmake.text);
  Violations found;
  for (const std::string option : {"-ffast-math", "-Ofast", "-march=native"}) {
    if (text.find(option) != std::string::npos) found.push_back(cmake.path + ": uses " + option);
  }
  return found;
}

Violations dead_links(const File& page, const std::function<bool(const std::string& path)>& there) {
  static const std::regex link(R"(\]\(([^):#]+)(?:#[^)]*)?\))");
  static const std::regex quoted(R"(`((?:proto|server|devices|client|tests)/[\w./-]*)`)");
  static const std::regex example(R"([A-Z]{2,})");
  Violations found;
  const std::string own = folder_of(page.path);
  for (auto it = std::sregex_iterator(page.text.begin(), page.text.end(), link);
       it != std::sregex_iterator(); ++it) {
    const std::string path =
        std::filesystem::path(own + "/" + it->str(1)).lexically_normal().string();
    if (!there(path))
      found.push_back(page.path + ": leads to " + it->str(1) + ", which is not there");
  }
  for (auto it = std::sregex_iterator(page.text.begin(), page.text.end(), quoted);
       it != std::sregex_iterator(); ++it) {
    const std::string path = it->str(1);
    if (!ends_with(path, ".md") && std::regex_search(path, example)) continue;
    if (!there(path)) found.push_back(page.path + ": names " + path + ", which is not there");
  }
  return found;
}

Violations assertions(const File& test) {
  static const std::regex head(
      R"(\b(?:TEST|TEST_F|TEST_P|TYPED_TEST|TYPED_TEST_P|RC_GTEST_PROP)\s*\(\s*(\w+)\s*,\s*(\w+))");
  static const std::regex asserts(
      R"(\b(?:EXPECT_|ASSERT_|RC_ASSERT|FAIL\(|ADD_FAILURE|NoAllocation|rc::check|(?:expect|assert|check|require)(?:_\w+)?\s*[(<]))");
  const std::string code = code_only(test.text);
  Violations found;
  for (auto it = std::sregex_iterator(code.begin(), code.end(), head); it != std::sregex_iterator();
       ++it) {
    const std::size_t open = code.find('{', static_cast<std::size_t>(it->position()));
    std::size_t end = open;
    for (int depth = 0; end < code.size(); ++end) {
      depth += code[end] == '{' ? 1 : (code[end] == '}' ? -1 : 0);
      if (depth == 0) break;
    }
    if (open == std::string::npos || !std::regex_search(code.substr(open, end - open), asserts)) {
      found.push_back(test.path + ": " + it->str(1) + "." + it->str(2) + " asserts nothing");
    }
  }
  return found;
}

}  // namespace handrail::lint
