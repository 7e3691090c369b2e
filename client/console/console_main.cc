// handrail-console: a gateway between browsers and a master, or a recording.
#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdio>
#include <functional>
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
#include "client/console/console_source.h"
#include "client/console/gateway/json_text.h"
#include "client/console/link_keeper.h"
#include "client/console/web_server.h"
#include "server/base/clock.h"
#include "server/base/output.h"
#include "server/base/signals.h"
#include "server/base/version.h"
#include "server/daemon/daemon_log.h"
#include "server/daemon/descriptors.h"
#include "server/daemon/run_daemon.h"
#include "server/keys/key_folder.h"
#include "server/keys/secret.h"
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

std::string recording_text(const pb::RecordingNews& recording) {
  std::string out = fmt::format("RECORDING {}: {} {}, {:.3f} s", recording.file(),
                                recording.program(), recording.version(), recording.length_s());
  if (recording.mark_size() > 0) out += fmt::format(", {} marks", recording.mark_size());
  return out;
}

// As a person reads it, or a program with --json: the address comes last.
std::string ready_text(const ConsoleArgs& args, const Access& access,
                       const pb::RecordingNews* recording) {
  pb::ConsoleReady ready;
  ready.set_url(access.url());
  if (!args.encrypted) ready.set_viewers(access.viewer_url());
  if (recording != nullptr) *ready.mutable_recording() = *recording;
  if (args.json) return json_text(ready);
  std::string out;
  if (recording != nullptr) out += recording_text(*recording) + "\n";
  if (ready.has_viewers()) out += "VIEWERS " + ready.viewers() + "\n";
  return out + "READY url=" + ready.url();
}

// What is to be printed: the addresses; of one that others reach, `handrail keys link` is to know
// it too. Viewers, whose secret does not end, are served on this computer alone.
Result<std::string> let_in(const ConsoleArgs& args, ConsoleIdentity& identity, std::uint16_t port,
                           const ConsoleSource& source, ConsoleApp& app, LinkKeeper& links) {
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
  const std::string lines = ready_text(args, access, source.recording());
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

KeyFollower::Told when_keys_change(WebServer& server, ConsoleSource& source) {
  return {[&](const ConsoleIdentity& now) {
            server.show(now.tls);
            spdlog::warn(
                "this user's key has changed: browsers that come are shown another certificate, "
                "whose SHA-256 begins {}, and warn once more; pages that are open stay",
                fingerprint_start(now.place.certificate));
          },
          [&] { source.renew(); },
          [](const std::string& why) {
            spdlog::warn("the keys have changed and are not followed: {}", why);
          }};
}

Result<std::unique_ptr<ConsoleSource>> source_of(const ConsoleArgs& args,
                                                 boost::asio::io_context& io, WebServer& server,
                                                 ViewerDesk& viewers) {
  const auto post = [&io](std::function<void()> work) { boost::asio::post(io, std::move(work)); };
  if (!args.recording.empty()) return recording_source(args, post, server, viewers);
  return Result<std::unique_ptr<ConsoleSource>>(live_source(args, post, server, viewers));
}

int serve(const ConsoleArgs& args) {
  KeyFollower keys(args);
  auto identity = ConsoleIdentity::of(args);
  if (!identity) return fail_start(kProgram, identity.message());
  raise_descriptor_limit(WebServer::kMostConnections + kOwnDescriptors);
  boost::asio::io_context io;
  WebServer server(io);
  ViewerDesk viewers(server, program_version(), std::to_string(calendar_now()));
  auto source = source_of(args, io, server, viewers);
  if (!source) return fail_start(kProgram, source.message());
  ConsoleApp app(page_of(args), (*source)->desk(), viewers, server);
  LinkKeeper links(io, OnceLinks(default_key_folder()));
  (*source)->show_to(app);
  if (const Status opened = server.open(args.address, args.port, app, identity->tls); !opened) {
    return fail_start(kProgram, opened.message());
  }
  const auto ready_line = let_in(args, *identity, server.port(), **source, app, links);
  if (!ready_line) return fail_start(kProgram, ready_line.message());
  keys.follow(*identity, when_keys_change(server, **source));
  boost::asio::steady_timer looks(io);
  keep_looking(looks, app, keys);
  boost::asio::signal_set endings(io);
  for (const int signal : ending_signals()) endings.add(signal);
  endings.async_wait([&io](const boost::system::error_code&, int) { io.stop(); });
  Announcement ready;
  if (args.recording.empty()) {
    ready.make(*ready_line);
  } else {
    // What is shown waits for nobody's hand: who cannot be told of it has no use for it.
    std::printf("%s\n", ready_line->c_str());
    if (const int code = end_output(kProgram, 0); code != 0) return code;
  }
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
