#include "client/cli/scene_command.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iomanip>

#include "client/cli/scene_view.h"
#include "server/scene/json_io.h"
#include "server/scene/scene_io.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

// A scene's file from its name, or the file itself when the argument looks like one.
Result<std::string> file_of(const std::string& word) {
  const bool is_file = word.find('/') != std::string::npos || word.ends_with(kSceneExtension);
  if (is_file) return word;
  return SceneLibrary().find(word);
}

void print_json(const std::vector<pb::SceneEntry>& entries, std::ostream& out) {
  out << "[";
  const char* separator = "\n";
  for (const pb::SceneEntry& entry : entries) {
    out << separator << json_text(entry, false);
    separator = ",\n";
  }
  out << "\n]\n";
}

void print_table(const std::vector<pb::SceneEntry>& entries, std::ostream& out) {
  std::size_t width = 0;
  for (const auto& entry : entries) width = std::max(width, entry.name().size());
  for (const auto& entry : entries) {
    out << std::left << std::setw(static_cast<int>(width) + 2) << entry.name()
        << (entry.valid() ? entry.description() : "INVALID  " + entry.error()) << '\n';
  }
}

// Beside this program.
std::string lab_program() {
  std::error_code error;
  const auto own = std::filesystem::read_symlink("/proc/self/exe", error);
  return (own.parent_path() / "handrail-lab").string();
}

// Runs handrail-lab with these words on this program's own standard output and error.
ExitCode run_lab(const Console& console, std::vector<std::string> words) {
  std::string path = lab_program();
  std::vector<char*> argv{path.data()};
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  console.out.flush();
  console.err.flush();
  pid_t pid = 0;
  const int failed = ::posix_spawn(&pid, path.c_str(), nullptr, nullptr, argv.data(), environ);
  if (failed != 0) return complain(console, "cannot start " + path + ": " + std::strerror(failed));
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status)) return static_cast<ExitCode>(WEXITSTATUS(status));
  console.err << "handrail: handrail-lab was ended by signal " << WTERMSIG(status) << '\n';
  return kExitRefused;
}

void add_option(const char* name, const std::optional<std::string>& value,
                std::vector<std::string>& words) {
  if (!value) return;
  words.push_back(name);
  words.push_back(*value);
}

}  // namespace

ExitCode run_scene_list(const Options& options, const Console& console) {
  std::vector<pb::SceneEntry> entries;
  for (const auto& [name, file] : SceneLibrary().list()) {
    const Result<Scene> scene = load_scene_file(file);
    pb::SceneEntry& entry = entries.emplace_back();
    entry.set_name(name);
    entry.set_file(file);
    entry.set_valid(scene.is_ok());
    entry.set_description(scene ? scene->description : std::string());
    entry.set_error(scene.message());
  }
  options.json ? print_json(entries, console.out) : print_table(entries, console.out);
  return kExitDone;
}

ExitCode run_scene_show(const Options& options, const Console& console) {
  const Result<std::string> file = file_of(*options.word);
  if (!file) return complain(console, file.message());
  pb::Scene raw;
  const Result<Scene> scene = load_scene_file(*file, &raw);
  if (!scene) return complain(console, scene.message());
  if (options.json) {
    console.out << json_text(with_sections(as_used(raw, *scene)), true) << '\n';
  } else {
    console.out << *file << '\n' << scene_text(as_used(raw, *scene));
  }
  return kExitDone;
}

ExitCode run_scene_check(const Options& options, const Console& console) {
  const Result<std::string> file = file_of(*options.word);
  if (!file) return complain(console, file.message());
  const Result<Scene> scene = load_scene_file(*file);
  if (!scene) return complain(console, scene.message());
  for (const std::string& warning : warnings_of(*scene)) {
    console.err << *file << ": warning: " << warning << '\n';
  }
  if (!options.json) console.out << *file << ": ok\n";
  if (::access(lab_program().c_str(), X_OK) != 0) {
    console.err << "handrail: what a device holds of it is not looked at: there is no "
                << lab_program() << '\n';
    return kExitDone;
  }
  std::vector<std::string> words = {"scene-stability", *file};
  if (options.json) words.push_back("--json");
  return run_lab(console, std::move(words));
}

ExitCode run_scene_preview(const Options& options, const Console& console) {
  std::vector<std::string> words = {"scene-preview", *options.word};
  add_option("--out", options.out, words);
  return run_lab(console, std::move(words));
}

ExitCode run_scene_explain(const Options& options, const Console& console) {
  std::vector<std::string> words = {"scene-explain", *options.word};
  if (options.json) words.push_back("--json");
  return run_lab(console, std::move(words));
}

ExitCode run_scene_resolve(const Options& options, const Console& console) {
  std::vector<std::string> words = {"scene-resolve", *options.word};
  add_option("--accuracy", options.accuracy, words);
  add_option("--budget", options.budget, words);
  add_option("--out", options.out, words);
  return run_lab(console, std::move(words));
}

ExitCode run_scene_load(const Options& options, const Console& console) {
  if (!is_scene_name(*options.word)) {
    return complain(console, "scene load: '" + *options.word +
                                 "': expected a scene's name such as linear-movement; master and "
                                 "slave each load their own file of that name");
  }
  pb::Request request;
  request.set_scene_load(*options.word);
  // The master waits 2 s for its disk and 3 s for the slave.
  return send_order(options, console, request, "scene " + *options.word + " loaded", 8 * kSecond);
}

}  // namespace handrail
