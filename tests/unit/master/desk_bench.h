// The order desk with a haptic loop and a slave that the test plays, in virtual time.
#pragma once

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/master/haptic_settings.h"
#include "server/master/order_desk.h"

namespace handrail {

class DeskBench : public ::testing::Test {
 protected:
  using Answer = std::shared_ptr<std::optional<pb::Reply>>;

  explicit DeskBench(bool led_by_cursor = false) {
    for (const char* name : {"first", "second"}) scenes[name].name = name;
    OrderDeskOptions options;
    options.identity.slave_at = "/run/link.sock";
    options.identity.device = "its device";
    options.identity.led_by_cursor = led_by_cursor;
    options.load_scene = [this](const std::string& name) -> std::optional<Result<Scene>> {
      if (disk_waits) return std::nullopt;
      if (!scenes.contains(name)) return Status::error("no scene '" + name + "'");
      return scenes[name];
    };
    options.loop_scene = [](const Scene& scene) {
      return LoopScene{haptic_settings(scene, HapticCapabilities())};
    };
    desk = std::make_unique<OrderDesk>(boxes, scenes["first"], options);
    take_over(haptic_settings(scenes["first"], HapticCapabilities()));
    slave_follows();
    link.peer_epoch = 1;
    link.received_of_100 = link.peer_received_of_100 = 100;
  }

  // The loop has these settings now.
  void take_over(const HapticSettings& settings) {
    report.out.link.hashes = settings.hashes;
    report.out.link.scene = settings.scene;
  }
  // Takes a scene that waits for the loop; its name, empty when none waits.
  std::string take_scene() {
    LoopScene next;
    if (!boxes.scene.take(next)) return "";
    take_over(next.haptic);
    ++report.scene_epoch;
    return std::string(text_of(next.haptic.scene));
  }
  void slave_follows() {
    slave.hashes = report.out.link.hashes;
    slave.scene = report.out.link.scene;
  }
  void stand(SessionState state, Desired desired = Desired::kOff, Reason reason = Reason::kNone) {
    report.out.link.state = state;
    report.out.link.desired = desired;
    report.out.reason = reason;
  }

  // Hands a request in, in text format. The answer has a value once the desk has replied.
  Answer ask(const std::string& text) {
    pb::Request request;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &request)) << text;
    return ask(request);
  }
  Answer ask(const pb::Request& request) {
    auto answer = std::make_shared<std::optional<pb::Reply>>();
    desk->handle(
        request, [answer](pb::Reply reply) { *answer = std::move(reply); },
        [this] { return still_waits; });
    return answer;
  }
  // The loop takes every order and answers it with `result`; `taken` keeps them.
  void loop(Reason result = Reason::kNone, double tool_distance = 0.0, double latched = 0.0) {
    OrderTicket ticket;
    while (boxes.orders.pop(ticket)) {
      taken.push_back(ticket);
      ASSERT_TRUE(boxes.answers.push({ticket.id, result, tool_distance, latched}));
    }
  }
  // A tick of the loop and then one of the desk.
  void tick(Nanos step = kMillisecond) {
    now += step;
    if (connected) link.received_at = now;
    ++report.ticks;
    boxes.report.publish(report);
    hear();
  }
  // A tick of the desk alone.
  void hear() {
    news.take(boxes);
    desk->tick(now, news, slave, link);
  }
  // The answer to an order that the loop carries out at once.
  std::string at_once(const std::string& request) {
    const Answer answer = ask(request);
    EXPECT_FALSE(answer->has_value()) << request << " answered before the loop had it";
    loop();
    tick();
    return text(answer);
  }
  // The answer to a request that never reaches the loop.
  std::string refusal(const std::string& request) {
    const Answer answer = ask(request);
    OrderTicket ticket;
    EXPECT_FALSE(boxes.orders.pop(ticket)) << request << " reached the loop";
    return text(answer);
  }
  // The order the loop took last.
  OrderKind last_order() const {
    return taken.empty() ? OrderKind::kNone : taken.back().order.kind;
  }

  static std::string text(const Answer& answer) {
    if (!answer->has_value()) return "(no answer)";
    return ((*answer)->done() ? "done: " : "refused: ") + (*answer)->reason();
  }

  MasterMailboxes boxes;
  LoopNews news;
  std::map<std::string, Scene> scenes;
  HapticReport report;
  SlaveState slave;
  LinkSnapshot link;
  bool connected = true;
  bool still_waits = true;  // whoever asks
  bool disk_waits = false;  // whoever reads a scene
  Nanos now = 1000 * kSecond;
  std::vector<OrderTicket> taken;
  std::unique_ptr<OrderDesk> desk;
};

}  // namespace handrail
