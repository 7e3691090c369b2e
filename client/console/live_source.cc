#include <spdlog/spdlog.h>

#include <optional>
#include <utility>
#include <vector>

#include "client/console/console_source.h"
#include "client/console/master_link.h"
#include "client/console/rig_link.h"
#include "server/base/clock.h"
#include "server/base/plain_text.h"
#include "server/base/version.h"
#include "server/daemon/errand.h"
#include "server/scene/scene_io.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

// The master's scene, from its own file where that is on this computer, else by its name.
Result<ReadScene> read_scene(const std::string& name, const std::string& file,
                             const SceneLibrary& library) {
  auto scene = file.empty() ? library.load(name) : load_scene_file(file);
  if (!scene) return scene.status();
  return with_picture(std::move(*scene));
}

// Keeps what is drawn that of the master's scene.
class SceneWatch {
 public:
  SceneWatch(const ConsoleArgs& args, ConsoleApp& app)
      : library_(std::make_shared<const SceneLibrary>(args.scenes)),
        local_(args.master.host.empty()),
        app_(app) {}

  void see(const pb::Status& status) {
    const std::string key =
        status.scene() + "\n" + status.scene_file() + "\n" + std::to_string(status.scene_epoch());
    if (reading_.empty() && key == shown_) return;
    if (reading_.empty()) {
      reading_ = key;
      name_ = status.scene();
    }
    const std::string file = local_ ? status.scene_file() : "";
    const auto read = errand_.poll(
        [name = name_, file, library = library_] { return read_scene(name, file, *library); });
    if (!read) return;
    shown_ = std::exchange(reading_, "");
    app_.show(name_, *read);
  }

 private:
  const std::shared_ptr<const SceneLibrary> library_;
  const bool local_;
  ConsoleApp& app_;
  Errand<Result<ReadScene>> errand_;
  std::string shown_, reading_, name_;
};

std::vector<std::string> scene_names(const ConsoleArgs& args) {
  std::vector<std::string> out;
  for (const SceneLibrary::Entry& scene : SceneLibrary(args.scenes).list()) {
    // What is no text a frame cannot hold.
    if (is_plain_text(scene.name)) out.push_back(scene.name);
  }
  return out;
}

class LiveSource final : public ConsoleSource {
 public:
  LiveSource(const ConsoleArgs& args, const Post& post, PageSink& pages, ViewerDesk& viewers)
      : args_(args),
        viewers_(viewers),
        link_({args.master, args.as, args.observe}, post,
              {[this](const Result<pb::Reply>& reply, Nanos asked) { see(reply, asked); },
               [this](std::uint64_t ticket, const Result<pb::Reply>& reply) {
                 desk_.answered(ticket, reply, monotonic_now());
               },
               [this](const Result<pb::Reply>& reply) { desk_.pointed(reply); }}),
        desk_(pages, link_,
              PageDeskOptions{args.observe, program_version(), args.as,
                              args.master.host.empty() ? args.master.socket : args.master.host,
                              scene_names(args)}) {
    if (args.rig.empty()) return;
    rig_ = std::make_unique<RigLink>(args.rig, post,
                                     [this](const pb::RigNews& news) { desk_.rig(news); });
  }

  PageDesk& desk() override { return desk_; }
  void show_to(ConsoleApp& app) override { scenes_ = std::make_unique<SceneWatch>(args_, app); }
  void renew() override { link_.renew(); }

 private:
  void see(const Result<pb::Reply>& reply, Nanos asked) {
    say_master(reply);
    if (reply && reply->has_status()) {
      if (scenes_) scenes_->see(reply->status());
      if (rig_) rig_->follow(reply->status().scene());
    }
    desk_.status(reply, asked, monotonic_now());
    viewers_.status(reply, calendar_now());
  }

  // Says in the log when the master comes and goes.
  void say_master(const Result<pb::Reply>& reply) {
    const std::string now = reply ? "" : reply.message();
    if (said_ == now) return;
    said_ = now;
    if (reply) return spdlog::info("the master answers");
    spdlog::warn("{}", now);
  }

  const ConsoleArgs args_;
  ViewerDesk& viewers_;
  std::optional<std::string> said_;
  std::unique_ptr<SceneWatch> scenes_;
  std::unique_ptr<RigLink> rig_;
  // What its threads have in hand comes while the gateway runs: the desk is there by then.
  MasterLink link_;
  PageDesk desk_;
};

}  // namespace

std::unique_ptr<ConsoleSource> live_source(const ConsoleArgs& args, ConsoleSource::Post post,
                                           PageSink& pages, ViewerDesk& viewers) {
  return std::make_unique<LiveSource>(args, post, pages, viewers);
}

}  // namespace handrail
