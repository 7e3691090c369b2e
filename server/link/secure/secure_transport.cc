#include "server/link/secure/secure_transport.h"

#include <memory>
#include <utility>

#include "server/link/secure/secure_client.h"
#include "server/link/secure/secure_server.h"
#include "server/link/secure/secure_text.h"
#include "server/link/secure/udp_socket.h"

namespace handrail {
namespace {

using Problem = DtlsChannel::Problem;

// A name's addresses may change; a resolver has a time-out of some seconds of its own.
constexpr Nanos kLookUpAgain = 5 * kSecond;
// Between two lines about strangers: anybody who reaches the port can cause one.
constexpr Nanos kStrangerPause = 10 * kSecond;
// ... when it is the same key again. Chosen.
constexpr Nanos kSameStrangerPause = 600 * kSecond;

LinkIdentity no_session(const LinkProblem& problem, std::string address) {
  LinkIdentity out;
  out.encrypted = true;
  out.address = std::move(address);
  out.problem = problem.text();
  out.next = problem.next;
  return out;
}

// What both ends have. `End`: SecureServer or SecureClient.
template <typename End>
class SecureTransport : public ServedTransport {
 public:
  SecureTransport(boost::asio::io_context& io, SecureLinkOptions options,
                  std::shared_ptr<SecureContext> context)
      : options_(std::move(options)), context_(std::move(context)), socket_(io) {}

  void on_readable(std::function<void()> readable) override {
    socket_.on_readable(std::move(readable));
  }
  void close() noexcept override { socket_.close(); }
  void on_say(Say say) override { say_ = std::move(say); }
  std::optional<Arrival> receive(std::span<std::uint8_t> buffer) noexcept override {
    return end_.receive(buffer);
  }
  void adopt_sender() noexcept override { end_.adopt_sender(); }
  bool send(std::span<const std::uint8_t> bytes) noexcept override { return end_.send(bytes); }
  bool answer(std::span<const std::uint8_t> bytes) noexcept override { return end_.answer(bytes); }
  std::string_view peer_name() const noexcept override { return end_.peer_name(); }

 protected:
  // "any:47002", "[2001:db8::7]:47002"; empty while closed.
  std::string place_at(const std::string& address) const {
    if (socket_.port() == 0) return {};
    const bool v6 = address.find(':') != std::string::npos;
    std::string out = v6 ? "[" : "";
    return out.append(address).append(v6 ? "]:" : ":").append(std::to_string(socket_.port()));
  }
  void say(bool bad, const std::string& line) {
    if (say_) say_(bad, line);
  }
  void take_keys(Nanos now) {
    if (!std::exchange(said_trusted_, true)) say_trusted();
    if (const auto begun = end_.take_begun()) settle_keys(options_, *begun);
    follow_keys(options_, now, changes_);
  }
  void say_own(const OwnEntry& own) {
    say(false, "keys: ours is " + key_id(own.key.public_key()) +
                   (own.next ? ", the next " + key_id(own.next->public_key()) : ""));
  }
  void say_trusted() {
    const Roles other = context_->wanted();
    const std::string those = those_trusted(options_.trusted, other);
    const bool nobody = those == "nobody";
    say(nobody, "keys: trusted as " + roles_text(other) + ": " + those +
                    (nobody ? "; `handrail keys show` there prints the line to type here" : ""));
  }
  // A session has begun, with another key or at another address, or ended.
  void say_session(const std::string& what, const DtlsChannel* channel) {
    const bool same = channel == nullptr ? !speaking_
                                         : speaking_ && said_at_ == channel->address() &&
                                               said_key_ == channel->peer().key;
    if (same) return;
    speaking_ = channel != nullptr;
    if (!speaking_) return say(false, "encrypted session ended");
    said_at_ = channel->address();
    said_key_ = channel->peer().key;
    say(false, what + session_text(options_.trusted, said_key_, said_at_));
  }
  LinkProblem why_not(Problem problem, const PeerKey& shown, const Address& at,
                      LinkRoles roles) const {
    return problem_of(problem, shown, at, options_.trusted, options_.own.entry(), roles);
  }

  const KeyChange changes_{[this](bool bad, const std::string& line) { say(bad, line); },
                           [this](const OwnEntry& own) {
                             Status set = end_.set_own(own.key, own.next);
                             if (set && own.entry() != options_.own.entry()) say_own(own);
                             return set;
                           },
                           [this](const TrustList& trusted) {
                             end_.set_trusted(trusted);
                             options_.trusted = trusted;
                             say_trusted();
                           }};
  SecureLinkOptions options_;
  std::shared_ptr<SecureContext> context_;
  UdpSocket socket_;
  End end_{*context_, socket_};
  Say say_;
  bool said_trusted_ = false;
  bool speaking_ = false;  // what was said last: with whom
  Address said_at_;
  PublicKey said_key_;
};

class ListeningTransport final : public SecureTransport<SecureServer> {
 public:
  ListeningTransport(boost::asio::io_context& io, SecureLinkOptions options,
                     std::shared_ptr<SecureContext> context, std::string address,
                     std::uint16_t port)
      : SecureTransport(io, std::move(options), std::move(context)),
        address_(std::move(address)),
        port_(port) {}

  Status open() override { return socket_.open(address_, port_); }
  std::string place() const override { return place_at(address_); }
  void tick(Nanos now) override {
    end_.tick(now);
    take_keys(now);
    say_session("encrypted session with ", end_.leader());
    const SecureServer::Refused& refused = end_.refused();
    if (refused.at == said_ || now < next_line_ || refused.problem == Problem::kNoAnswer) return;
    said_ = refused.at;
    // A master whose next key is not trusted yet tries it again and again.
    if (refused.peer.shown && refused.peer.key == said_stranger_ && now < same_again_) return;
    said_stranger_ = refused.peer.key;
    same_again_ = now + kSameStrangerPause;
    next_line_ = now + kStrangerPause;
    say(true, "refused: " + why_not(refused.problem, refused.peer, refused.from,
                                    {Role::kSlave, Role::kMaster})
                                .text());
  }
  LinkIdentity identity(Nanos now) const override {
    const DtlsChannel* leader = end_.leader();
    if (leader == nullptr) return no_session({}, {});
    return {true,
            std::string(end_.peer_name()),
            key_id(leader->peer().key),
            address_text(leader->address()),
            now - end_.leader_since(),
            {},
            {}};
  }

 private:
  std::string address_;
  std::uint16_t port_;
  Nanos said_ = -kForever, next_line_ = -kForever, same_again_ = -kForever;
  PublicKey said_stranger_;
};

class CallingTransport final : public SecureTransport<SecureClient> {
 public:
  CallingTransport(boost::asio::io_context& io, SecureLinkOptions options,
                   std::shared_ptr<SecureContext> context, HostPort slave)
      : SecureTransport(io, std::move(options), std::move(context)),
        slave_(std::move(slave)),
        resolver_(io) {}

  Status open() override { return socket_.open("any", 0); }
  std::string place() const override { return place_at("any"); }
  void tick(Nanos now) override {
    if (end_.calls() && now >= look_up_at_) {
      look_up_at_ = now + kLookUpAgain;
      resolver_.ask(slave_, [this](const Result<std::vector<Address>>& found) {
        lookup_ = found ? LinkProblem()
                        : LinkProblem{"slave " + found.message(),
                                      "start the master with the name or the address that the "
                                      "slave's computer has"};
        if (found) end_.set_addresses(*found);
      });
    }
    end_.tick(now);
    take_keys(now);
    say_session("encrypted session with ", end_.session());
    LinkProblem problem = problem_now();
    if (problem.text() == problem_.text()) return;
    problem_ = std::move(problem);
    if (!problem_.fact.empty()) say(true, problem_.text());
  }
  LinkIdentity identity(Nanos now) const override {
    const DtlsChannel* session = end_.session();
    if (session == nullptr) return no_session(problem_, called());
    return {true,
            std::string(end_.peer_name()),
            key_id(session->peer().key),
            address_text(session->address()),
            now - end_.session_since(),
            problem_.text(),
            problem_.next};
  }

 private:
  // Where the slave is looked for; empty while its name has no address.
  std::string called() const {
    return end_.tried().port == 0 ? std::string() : address_text(end_.tried());
  }
  LinkProblem problem_now() const {
    if (!end_.calls()) return {};
    if (!lookup_.fact.empty()) return lookup_;
    return why_not(end_.problem(), end_.refused(), end_.tried(), {Role::kMaster, Role::kSlave});
  }

  HostPort slave_;
  PeerResolver resolver_;
  Nanos look_up_at_ = -kForever;
  LinkProblem lookup_;   // why the name gives no address
  LinkProblem problem_;  // said last
};

Result<std::shared_ptr<SecureContext>> context_of(const SecureLinkOptions& options,
                                                  SecureContext::Side side, Role wanted) {
  auto made = SecureContext::make(options.own.key, options.trusted, side, wanted);
  if (!made) return made.status();
  if (Status set = (*made)->set_own(options.own.key, options.own.next); !set) return set;
  return std::shared_ptr<SecureContext>(std::move(*made));
}

}  // namespace

Result<SecureLinkOptions> secure_options(const KeyFolder& folder, const std::string& what) {
  const std::string stamp = folder.stamp();
  auto own = folder.load();
  if (!own) return Status::error(what + " needs a key: " + own.message());
  auto trusted = folder.trusted();
  if (!trusted) return trusted.status();
  return SecureLinkOptions{*own, *trusted, std::make_shared<KeyWatch>(folder, stamp)};
}

void settle_keys(const SecureLinkOptions& options, const SessionKeys& begun) {
  if (options.watch == nullptr) return;
  const Trusted* who = options.trusted.find(begun.theirs);
  const bool settles =
      options.own.entry().next == begun.ours || (who != nullptr && who->next == begun.theirs);
  if (settles) options.watch->begun(begun);
}

void follow_keys(SecureLinkOptions& options, Nanos now, const KeyChange& change) {
  const auto news = options.watch == nullptr ? std::nullopt : options.watch->poll(now);
  if (!news) return;
  const auto complain = [&](const Status& problem, const char* what_stays) {
    if (!problem) change.say(true, "keys: " + problem.message() + what_stays);
  };
  complain(news->status(), "");
  if (!*news) return;
  complain((*news)->settled, "");
  if (const auto& own = (*news)->own) {
    const Status set = *own ? change.take_own(**own) : own->status();
    complain(set, "; the key read before stays in use");
    if (set) options.own = **own;
  }
  if (const auto& trusted = (*news)->trusted) {
    // What cannot be read lets nobody in, and nobody out whom it may still name.
    complain(trusted->status(), "; those trusted before stay so");
    if (*trusted && **trusted != options.trusted) {
      change.take_trusted(**trusted);
      options.trusted = **trusted;
    }
  }
}

Result<TransportMaker> listening_link(SecureLinkOptions options, std::string address,
                                      std::uint16_t port) {
  const auto context = context_of(options, SecureContext::Side::kServer, Role::kMaster);
  if (!context) return context.status();
  return TransportMaker([options = std::move(options), context = *context,
                         address = std::move(address), port](boost::asio::io_context& io) {
    return std::make_unique<ListeningTransport>(io, options, context, address, port);
  });
}

Result<TransportMaker> calling_link(SecureLinkOptions options, HostPort slave) {
  const auto context = context_of(options, SecureContext::Side::kClient, Role::kSlave);
  if (!context) return context.status();
  return TransportMaker([options = std::move(options), context = *context,
                         slave = std::move(slave)](boost::asio::io_context& io) {
    return std::make_unique<CallingTransport>(io, options, context, slave);
  });
}

}  // namespace handrail
