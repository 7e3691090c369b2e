// handrail-console: a gateway between browsers and a master.
#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <utility>

#include "client/console/console_app.h"
#include "client/console/console_args.h"
#include "client/console/console_identity.h"
#include "client/console/link_keeper.h"
#include "client/console/master_link.h"
#include "client/console/rig_link.h"
#include "client/console/web_server.h"
#include "server/base/clock.h"
#include "server/base/output.h"
#include "server/base/plain_text.h"
#include "server/base/signals.h"
#include "server/base/version.h"
#include "server/daemon/daemon_log.h"
#include "server/daemon/descriptors.h"
#include "server/daemon/errand.h"
#include "server/daemon/run_daemon.h"
#include "server/keys/key_folder.h"
#include "server/keys/secret.h"
#include "server/scene/scene_io.h"
#include "server/scene/scene_library.h"
#include "server/scene/shipped.h"

namespace handrail {
namespace {

constexpr char kProgram[] = "handrail-console";
// Beside the connections: its log, its listener, the master's sockets, the files it reads.
constexpr std::size_t kOwnDescriptors = 64;

Site page_of(const ConsoleArgs& args) {
  std::vector<std::string> folders = {args.page};
  if (args.page.empty()) folders = shipped_folders(HANDRAIL_CONSOLE_PAGE, "console");
  std::string why = "`client/install --console` builds it.";
  for (const std::string& folder : folders) {
    auto site = Site::read(folder);
    if (site) return std::move(*site);
    why = site.message();
    if (folder == folders.front()) spdlog::warn("{}", why);
  }
  return Site::without_page(why);
}

// The master's scene, from its own file where that is on this computer, else by its name.
Result<ReadScene> read_scene(const std::string& name, const std::string& file,
                             const SceneLibrary& library) {
  auto scene = file.empty() ? library.load(name) : load_scene_file(file);
  if (!scene) return scene.status();
  ReadScene out{std::move(*scene), {}};
  if (out.scene.walls) {
    auto picture = map_picture(*out.scene.walls);
    if (!picture) return picture.status();
    out.picture = std::move(*picture);
  }
  return out;
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

// Says in the log when the master comes and goes.
void say_master(const Result<pb::Reply>& reply, std::string& last) {
  const std::string now = reply ? "" : reply.message();
  if (now == last) return;
  last = now;
  if (reply) return spdlog::info("the master answers");
  spdlog::warn("{}", now);
}

// What is to be printed: the addresses; of one that others reach, `handrail keys link` is to know
// it too. Viewers, whose secret does not end, are served on this computer alone.
Result<std::string> let_in(const ConsoleArgs& args, ConsoleIdentity& identity, std::uint16_t port,
                           ConsoleApp& app, LinkKeeper& links) {
  std::string key, cookie, viewer_key;
  if (!args.encrypted) {
    for (std::string* secret : {&key, &cookie, &viewer_key}) {
      const auto made = new_secret();
      if (!made) return made.status();
      *secret = *made;
    }
  } else {
    identity.place.port = port;
    if (Status saved = identity.place.save(default_key_folder()); !saved) return saved;
  }
  GatewayPlace place{{}, port, args.encrypted};
  for (const std::string& name : args.names) place.names.push_back(web_host(name));
  Access access(std::move(place), key, cookie);
  access.open_to_viewers(viewer_key, args.viewer_origins);
  const std::string ready = "READY url=" + access.url();
  const std::string lines =
      args.encrypted ? ready : "VIEWERS " + access.viewer_url() + "\n" + ready;
  app.let_in(std::move(access), args.encrypted ? &links : nullptr);
  if (!args.encrypted) return lines;
  spdlog::info(
      "`handrail keys link` makes addresses that let a browser in, once each; the "
      "certificate's SHA-256 begins {}",
      fingerprint_start(identity.place.certificate));
  return lines;
}

// Now and then, while the context runs.
void keep_looking(boost::asio::steady_timer& timer, ConsoleApp& app, KeyFollower& keys) {
  timer.expires_after(std::chrono::milliseconds(LinkKeeper::kLookMs));
  timer.async_wait([&](const boost::system::error_code& ended) {
    if (ended) return;
    app.look();
    keys.look();
    keep_looking(timer, app, keys);
  });
}

KeyFollower::Told when_keys_change(WebServer& server, MasterLink& link) {
  return {[&](const ConsoleIdentity& now) {
            server.show(now.tls);
            spdlog::warn(
                "this user's key has changed: browsers that come are shown another certificate, "
                "whose SHA-256 begins {}, and warn once more; pages that are open stay",
                fingerprint_start(now.place.certificate));
          },
          [&] { link.renew(); },
          [](const std::string& why) {
            spdlog::warn("the keys have changed and are not followed: {}", why);
          }};
}

int serve(const ConsoleArgs& args) {
  KeyFollower keys(args);
  auto identity = ConsoleIdentity::of(args);
  if (!identity) return fail_start(kProgram, identity.message());
  raise_descriptor_limit(WebServer::kMostConnections + kOwnDescriptors);
  boost::asio::io_context io;
  WebServer server(io);
  // What these two have in hand comes while the context runs: the desk is there by then.
  std::unique_ptr<PageDesk> desk;
  std::unique_ptr<SceneWatch> scenes;
  std::unique_ptr<RigLink> rig;
  const auto post = [&io](std::function<void()> work) { boost::asio::post(io, std::move(work)); };
  ViewerDesk viewers(server, program_version(), std::to_string(calendar_now()));
  std::string said = "?";
  const MasterLink::Told told{[&](const Result<pb::Reply>& reply, Nanos asked) {
                                say_master(reply, said);
                                if (reply && reply->has_status()) {
                                  scenes->see(reply->status());
                                  if (rig) rig->follow(reply->status().scene());
                                }
                                desk->status(reply, asked, monotonic_now());
                                viewers.status(reply, calendar_now());
                              },
                              [&](std::uint64_t ticket, const Result<pb::Reply>& reply) {
                                desk->answered(ticket, reply, monotonic_now());
                              },
                              [&](const Result<pb::Reply>& reply) { desk->pointed(reply); }};
  MasterLink link({args.master, args.as, args.observe}, post, told);
  const std::string master = args.master.host.empty() ? args.master.socket : args.master.host;
  desk = std::make_unique<PageDesk>(
      server, link,
      PageDeskOptions{args.observe, program_version(), args.as, master, scene_names(args)});
  if (!args.rig.empty()) {
    rig = std::make_unique<RigLink>(args.rig, post,
                                    [&desk](const pb::RigNews& news) { desk->rig(news); });
  }
  ConsoleApp app(page_of(args), *desk, viewers, server);
  LinkKeeper links(io, OnceLinks(default_key_folder()));
  scenes = std::make_unique<SceneWatch>(args, app);
  if (const Status opened = server.open(args.address, args.port, app, identity->tls); !opened) {
    return fail_start(kProgram, opened.message());
  }
  const auto ready_line = let_in(args, *identity, server.port(), app, links);
  if (!ready_line) return fail_start(kProgram, ready_line.message());
  keys.follow(*identity, when_keys_change(server, link));
  boost::asio::steady_timer looks(io);
  keep_looking(looks, app, keys);
  boost::asio::signal_set endings(io);
  for (const int signal : ending_signals()) endings.add(signal);
  endings.async_wait([&io](const boost::system::error_code&, int) { io.stop(); });
  Announcement ready;
  ready.make(*ready_line);
  io.run();
  server.close();
  return 0;
}

int run(int argc, char** argv) {
  const auto args = parse_console_args(argc, argv);
  if (!args) return fail_start(kProgram, args.message());
  if (args->help) std::fputs(console_help().c_str(), stdout);
  if (args->version) std::printf("%s %s\n", kProgram, program_version());
  if (args->help || args->version) return end_output(kProgram, 0);
  const DaemonLog log(kProgram, 0);
  return serve(*args);
}

}  // namespace
}  // namespace handrail

int main(int argc, char** argv) {
  return handrail::run_daemon("handrail-console", [&] { return handrail::run(argc, argv); });
}
