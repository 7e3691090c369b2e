// The master's side of the operator protocol: bytes of several clients, in pieces, to requests, and
// those through the order desk with a haptic loop that answers as the input says. The input is a
// row of acts, each a byte and what it needs.
#include <spdlog/spdlog.h>

#include <array>
#include <memory>
#include <utility>

#include "server/base/length_prefix.h"
#include "server/base/plain_text.h"
#include "server/master/haptic_settings.h"
#include "server/master/order_desk.h"
#include "server/master/request_stream.h"
#include "server/scene/scene_library.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail {
namespace {

using fuzz::require;

struct DeskClient {
  RequestStream in;
  bool open = true;
  bool waits = false;  // for the answer to what it asked
};

class Desk {
 public:
  explicit Desk(fuzz::Bytes bytes) : in_(bytes) {
    OrderDeskOptions options;
    options.identity.slave_at = "127.0.0.1:47002";
    options.load_scene = [this](const std::string& name) { return load(name); };
    options.loop_scene = [](const Scene& scene) {
      return LoopScene{haptic_settings(scene, HapticCapabilities())};
    };
    Scene first;
    first.name = "first";
    desk_ = std::make_unique<OrderDesk>(boxes_, first, options);
    take_over(haptic_settings(first, HapticCapabilities()));
    link_.peer_epoch = 1;
  }

  void run() {
    const std::size_t most = fuzz::most_acts(in_.left());
    for (std::size_t acts = 0; !in_.empty() && acts < most; ++acts)
      act(in_.take<std::uint8_t>() % 8);
    // Whoever asks is answered: a minute is longer than any patience. What else was sent waits.
    ending_ = true;
    answers_ = Reason::kNone;
    disk_waits_ = false;
    for (int i = 0; i < 110 && someone_waits(); ++i) {
      loop();
      loop();
      tick(i < 50 ? kMillisecond : kSecond);
    }
    require(!someone_waits(), "every request is answered");
  }

 private:
  void act(int what) {
    switch (what) {
      case 0: tick(kMillisecond); break;
      case 1: tick(Nanos{1} << in_.take<std::uint8_t>() % 36); break;
      case 2: loop(); break;
      case 3: {
        answers_ = Reason{static_cast<std::uint8_t>(in_.take<std::uint16_t>() %
                                                    static_cast<int>(Reason::kCount))};
        break;
      }
      case 4: stand(); break;
      case 5: {
        DeskClient& client = any_client();
        hear(client, in_.take_bytes(in_.take<std::uint8_t>()));
        break;
      }
      case 6: {  // a whole frame
        DeskClient& client = any_client();
        const std::string frame = framed(fuzz::text_of(in_.take_bytes(in_.take<std::uint8_t>())));
        hear(client, {reinterpret_cast<const std::uint8_t*>(frame.data()), frame.size()});
        break;
      }
      default: any_client().open = false;
    }
  }
  DeskClient& any_client() { return *clients_[in_.take<std::uint8_t>() % clients_.size()]; }
  // Who has hung up need not be answered.
  bool someone_waits() const {
    return std::any_of(clients_.begin(), clients_.end(),
                       [](const auto& c) { return c->open && c->waits; });
  }

  // As the server does: one request at a time.
  void hear(DeskClient& client, fuzz::Bytes bytes) {
    if (!client.open) return;
    client.in.append(fuzz::text_of(bytes));
    take_request(client);
  }
  void take_request(DeskClient& client) {
    while (client.open && !client.waits && !ending_) {
      auto request = client.in.next();
      if (!request) return;
      if (!request->is_ok()) {
        require(is_plain_text(request->message()), "a refusal is plain text");
        client.open = false;
        return;
      }
      const std::string problem = claim_request(nullptr, **request);
      require(is_plain_text(problem), "why a request is nobody's is plain text");
      if (!problem.empty()) continue;
      client.waits = true;
      const auto self = std::find_if(clients_.begin(), clients_.end(),
                                     [&](const auto& c) { return c.get() == &client; });
      desk_->handle(
          **request, [c = *self](pb::Reply reply) { answer(*c, reply); },
          [c = *self] { return c->open; });
      (void)desk_->may_drive(std::nullopt);
    }
  }
  static void answer(DeskClient& client, const pb::Reply& reply) {
    require(client.waits, "a request is answered once");
    client.waits = false;
    require(reply.ByteSizeLong() <= kMaxFrame, "an answer fits into a frame");
    require(is_plain_text(reply.reason()), "an answer is plain text: " + reply.reason());
    pb::Reply again;
    require(again.ParseFromString(reply.SerializeAsString()), "an answer can be read");
  }

  std::optional<Result<Scene>> load(const std::string& name) {
    if (disk_waits_) return std::nullopt;
    if (const auto file = library_.find(name); !file) return file.status();
    Scene scene;
    scene.name = name;
    return scene;
  }
  void take_over(const HapticSettings& settings) {
    report_.out.link.hashes = settings.hashes;
    report_.out.link.scene = settings.scene;
  }
  void loop() {
    if (boxes_.scene.take(next_)) {
      take_over(next_.haptic);
      ++report_.scene_epoch;
      moved_ = true;
    }
    OrderTicket ticket;
    if (!boxes_.orders.pop(ticket)) return;
    if (ticket.order.kind == OrderKind::kGrip) report_.out.link.grip = ticket.order.grip;
    (void)boxes_.answers.push({ticket.id, answers_, 0.3, 0.1});
  }
  // Where loop and slave stand, and how the link is.
  void stand() {
    const auto how = in_.take<std::uint32_t>();
    moved_ = true;
    const auto state = [&](int shift) {
      return SessionState{
          static_cast<std::uint8_t>((how >> shift & 15) % static_cast<int>(SessionState::kCount))};
    };
    report_.out.link.state = state(0);
    slave_.state = state(4);
    report_.out.link.desired = Desired{static_cast<std::uint8_t>((how >> 8 & 3) % 3)};
    if ((how >> 10 & 1) != 0) slave_.hashes = report_.out.link.hashes;
    if ((how >> 11 & 1) != 0) slave_.scene = report_.out.link.scene;
    if ((how >> 12 & 1) != 0) slave_.stop_epoch = report_.out.link.stop_epoch;
    report_.out.link.stop_epoch += how >> 13 & 1;
    connected_ = (how >> 14 & 1) != 0;
    slave_.gripper = GripperState{static_cast<std::uint8_t>(how >> 24 & 3)};
    disk_waits_ = (how >> 15 & 1) != 0;
    slave_.reason = slave_.fault =
        Reason{static_cast<std::uint8_t>((how >> 16) % static_cast<unsigned>(Reason::kCount))};
  }
  void tick(Nanos step) {
    now_ += step;
    if (connected_) link_.received_at = now_;
    if (std::exchange(moved_, false)) boxes_.report.publish(report_);
    news_.take(boxes_);
    desk_->tick(now_, news_, slave_, link_);
    for (const auto& client : clients_) take_request(*client);
  }

  fuzz::Input in_;
  MasterMailboxes boxes_;
  LoopNews news_;
  HapticReport report_;
  LoopScene next_;
  SlaveState slave_;
  LinkSnapshot link_;
  bool moved_ = true;  // the loop's report is another one
  bool connected_ = true, disk_waits_ = false, ending_ = false;
  Reason answers_ = Reason::kNone;
  Nanos now_ = 1000 * kSecond;
  SceneLibrary library_;
  std::array<std::shared_ptr<DeskClient>, 3> clients_{std::make_shared<DeskClient>(),
                                                      std::make_shared<DeskClient>(),
                                                      std::make_shared<DeskClient>()};
  std::unique_ptr<OrderDesk> desk_;
};

}  // namespace

HANDRAIL_FUZZ(operator_requests) {
  spdlog::set_level(spdlog::level::off);
  Desk(bytes).run();
}

}  // namespace handrail
