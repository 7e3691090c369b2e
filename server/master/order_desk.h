// Operators' requests, from arrival to answer.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/master/lease_desk.h"
#include "server/master/loop_news.h"
#include "server/master/mailboxes.h"
#include "server/master/operator_server.h"
#include "server/master/status_report.h"
#include "server/master/why_report.h"
#include "server/model/scene.h"
#include "server/record/recorder.h"

namespace handrail {

struct OrderDeskOptions {
  MasterIdentity identity;
  Presence presence = Presence::kNone;  // what the configuration wants
  std::string user = "operator";        // who speaks when a request does not say
  // A scene by name; the error says why there is none. Must not wait: asked again every tick while
  // it gives nothing, as the disk takes its time.
  std::function<std::optional<Result<Scene>>(const std::string& name)> load_scene;
  // What it means with this device.
  std::function<LoopScene(const Scene& scene)> loop_scene;
  Recorder* recorder = nullptr;  // not owned; null: nothing is kept
  std::string record_folder;     // where it writes
};

// Turns the requests of who may drive into orders for the haptic loop and answers them once they
// have taken effect: most in the next tick, engaging when both sides stand, a stop, a reset
// and a scene when the slave has them too. All methods in the IO thread.
class OrderDesk : public OperatorHandler {
 public:
  static constexpr Nanos kEngagePatience = 3 * kSecond;
  static constexpr Nanos kLinkPatience = 3 * kSecond;  // for a link good enough to engage over
  static constexpr Nanos kEngageRetry = 20 * kMillisecond;
  static constexpr Nanos kStopPatience = kSecond;
  static constexpr Nanos kResetPatience = kSecond;
  static constexpr Nanos kGripPatience = kSecond;  // for the controller's outputs, as for a stop
  static constexpr Nanos kScenePatience = 3 * kSecond;  // a slave looks once a second
  static constexpr Nanos kReadPatience = 2 * kSecond;   // before that, for the disk
  static constexpr std::size_t kMostOrders = 64;        // that wait for the loop
  // That the loop has at a time: it takes one a tick, and a stop comes after them.
  static constexpr int kOrdersInLoop = 2;

  // The mailboxes must outlive the desk. `scene` is the one the loop has.
  OrderDesk(MasterMailboxes& boxes, Scene scene, OrderDeskOptions options);

  // What the haptic thread got, once it is known.
  void set_link(std::function<LinkIdentity(Nanos)> link) {
    options_.identity.link = std::move(link);
  }
  void set_realtime(std::string report) { options_.identity.realtime = std::move(report); }
  void set_grants(const RealtimeGrants& grants) { options_.identity.grants = grants; }

  void handle(const pb::Request& request, std::function<void(pb::Reply)> reply,
              StillWaits waits) override;
  bool may_drive(const std::optional<std::string>& as) const override;

  // A millisecond has passed: hears what the loop has said, answers who waits.
  void tick(Nanos now, const LoopNews& loop, const SlaveState& slave, const LinkSnapshot& link);

 private:
  using ReplyTo = std::function<void(pb::Reply)>;
  // What an order waits for before it is answered, once the loop has taken it.
  enum class Until : std::uint8_t {
    kTaken,
    kDropped,
    kEngaged,
    kSlaveReset,
    kSlaveStopped,
    kScene,
    kGripped,
  };
  // How far an order has come.
  enum class Place : std::uint8_t { kHere, kInLoop, kTaken };
  // An order that is not answered yet.
  struct Pending {
    ReplyTo reply;
    Until until = Until::kTaken;
    Nanos since = 0;
    ToolCall tool{};    // what was called, if a tool was
    bool hold = false;  // kEngaged: what comes of it ends with a running `engage --hold`
    Place place = Place::kInLoop;
    std::uint64_t id = 0;       // kInLoop: the loop's number of it
    Nanos deadline = kForever;  // kTaken: for what it waits for
    StillWaits waits{};         // kEngaged: somebody for the answer
    std::string name{};         // of the scene's tool that was called by it; else empty
    Grip grip{};                // kGripped: what was wanted
  };

  // The request is its sender's to make.
  void obey(const pb::Request& request, const std::string& who, ReplyTo reply, StillWaits waits);
  void watch_lease();
  void end_engagement(Reason why);
  void order(HapticOrder order, ReplyTo reply, Until until = Until::kTaken);
  void hand(const pb::HandMove& move, ReplyTo reply);
  void cursor(const pb::CursorOrder& wanted, const ReplyTo& reply);
  // What the scene knows of what the status shows.
  void show_scene(pb::Status& status) const;
  void show_cursor(pb::Status& status) const;
  void tool(const pb::Tool& wanted, bool approach, ReplyTo reply);
  void named_tool(const std::string& name, bool approach, ReplyTo reply);
  // Its name is empty if it has none.
  void call_tool(NamedTool tool, bool approach, ReplyTo reply);
  void show_named_tools(pb::Status& status) const;
  // How far the tool called is, where that matters; else empty.
  std::string distance_text(const OrderAnswer& answer, const ToolCall& call) const;
  void mark(const std::string& text, const std::string& who, const ReplyTo& reply);
  void prompt(const pb::Request& wanted, const ReplyTo& reply);
  void record(const pb::RecordOrder& wanted, const std::string& who, const ReplyTo& reply);
  void show_task(pb::Status& status) const;
  void show_recording(pb::Status& status) const;
  void stage(const std::string& name, ReplyTo reply);
  void screw(double c, ReplyTo reply);
  void grip(bool closed, ReplyTo reply);
  void load(const std::string& name, const std::string& who, ReplyTo reply);
  void push(OrderTicket ticket, Pending order);
  void feed_loop();
  void take(const OrderAnswer& answer);
  void settle(const OrderAnswer& answer, Pending order);
  // Whether one waits for this, at that place of its way.
  bool waits(Until until, Place place) const;
  // Takes the first of these out, if there is one.
  std::optional<Pending> take(Until until, Place place);
  void refuse_all(Until until, Place place, const std::string& why);
  // The answer to an order that the loop has taken, once it can be given.
  std::optional<pb::Reply> check(const Pending& order);
  std::optional<pb::Reply> check_stop(const Pending& order) const;
  std::optional<pb::Reply> check_reset(const Pending& order) const;
  std::optional<pb::Reply> check_engaged(const Pending& order);
  std::optional<pb::Reply> check_gripped(const Pending& order) const;
  std::optional<pb::Reply> check_scene(const Pending& order);
  void answer_taken();
  void stop(ReplyTo reply);
  void engage(bool hold, ReplyTo reply, StillWaits waits);
  bool engage_waits() const;
  // An engage that is refused leaves the lease as it was.
  void give_back_lease();
  void hold_alive(ReplyTo reply);
  // An `engage --hold` has come that is neither taken nor refused yet.
  bool hold_waits() const;
  void watch_hold();
  void retry_engaging();
  // Whoever still waits for a better link to engage over waits no longer.
  void give_up_engaging();
  // That no slave hears this master, and why.
  std::string unheard() const;
  // Why no session over the encrypted link can be had; empty: one is, or nothing is known.
  std::string link_problem() const;
  // A session over the encrypted link may be had any moment: nothing is known against it.
  bool session_on_its_way() const;
  bool stop_on_its_way() const;
  void send_reset();
  bool scene_may_change() const;
  void take_scene();
  void call_scene_tools();
  // Gives a scene up again that the slave cannot have.
  pb::Reply take_scene_back(const std::string& problem);

  MasterMailboxes& boxes_;
  OrderDeskOptions options_;
  LeaseDesk leases_;
  Scene scene_;
  std::optional<HapticReport> report_;
  SlaveState slave_;
  LinkSnapshot link_;
  Nanos now_ = 0;
  std::uint64_t next_id_ = 1;
  std::vector<Pending> pending_;   // in the order in which they came to their place
  std::deque<OrderTicket> queue_;  // that the loop has yet to get
  int in_loop_ = 0;                // that it has got and not answered

  CursorSample cursor_;  // the newest
  pb::MarkStatus mark_;  // likewise; without a count: none
  std::string prompt_;
  std::vector<double> ball_mm_;  // that goes with it
  Nanos prompted_ = -kForever;

  Nanos retry_at_ = 0;  // an engage refused for the link
  bool hold_ = false;   // the engagement the loop took ends with a running `engage --hold`
  Nanos hold_heard_ = -kForever;

  std::string borrower_;  // who took a free lease for an engage that is not answered yet
  bool was_engaged_ = false;
  int scene_tools_ = 0;        // called, not answered yet
  std::string tools_refused_;  // of the scene's own, why

  struct CalledByName {
    std::uint32_t id = 0;  // as in ToolDefinition; 0: none was
    std::string name;
  };
  std::array<CalledByName, 2> called_by_name_;  // the newest orientation tool, position tool

  struct Reading {
    std::string scene, who;
  };
  std::optional<Reading> reading_;  // until the disk has given it
  Nanos load_shown_ = kForever;     // when the loop's report first had the scene
  std::uint64_t load_epoch_ = 0;    // scenes the loop had taken over before it
  std::optional<Scene> previous_;   // taken back when the slave does not follow
};

}  // namespace handrail
