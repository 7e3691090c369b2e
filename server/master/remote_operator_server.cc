#include "server/master/remote_operator_server.h"

#include <openssl/ssl.h>

#include <algorithm>
#include <array>
#include <new>
#include <optional>
#include <tuple>

#include <boost/asio/buffer.hpp>
#include <boost/asio/local/connect_pair.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/write.hpp>

#include "server/base/clock.h"
#include "server/keys/own_socket.h"
#include "server/link/secure/secure_text.h"
#include "server/link/secure/udp_socket.h"

namespace handrail {
namespace {

namespace ssl = boost::asio::ssl;
using boost::asio::ip::tcp;
using Local = boost::asio::local::stream_protocol::socket;
using TlsError = boost::system::error_code;

// Where one of `address` may have all the others too.
Address network_of(Address address) {
  const bool v4 = is_v4(address);
  if (!v4) std::fill(address.ip.begin() + 8, address.ip.end(), std::uint8_t{0});
  address.port = 0;
  return address;
}

const Roles kOperators = {Role::kOperator, Role::kObserver};
// Between two lines about strangers: anybody who reaches the port can cause one.
constexpr Nanos kLinePause = 10 * kSecond;

}  // namespace

// One connection: a handshake, and then bytes both ways between the network and the OperatorServer.
class RemoteOperatorServer::Session : public std::enable_shared_from_this<Session> {
  // A handler that calls `f` while the connection is open; ends it where memory has run out. Keeps
  // it alive.
  template <typename F>
  auto guarded(F f) {
    return [self = shared_from_this(), f](TlsError error, std::size_t size = 0) {
      if (!self->is_open()) return;
      try {
        f(error, size);
      } catch (const std::bad_alloc&) {
        self->end();
      }
    };
  }

 public:
  Session(tcp::socket socket, RemoteOperatorServer& server)
      : server_(server), waiting_(std::move(socket)), inner_(waiting_.get_executor()) {}

  // Waits for the first bytes: nobody's turn is spent on who says nothing.
  void begin() {
    since_ = heard_ = monotonic_now();
    TlsError gone;
    const tcp::endpoint from = waiting_.remote_endpoint(gone);
    if (!gone) from_ = address_of({from.address(), from.port()});
    if (!gone) waiting_.set_option(tcp::no_delay(true), gone);
    if (!gone) waiting_.non_blocking(true, gone);
    if (gone) return end();
    limit_time();
    waiting_.async_wait(tcp::socket::wait_read,
                        guarded([this](TlsError error, std::size_t) { hear_hello(error); }));
  }
  bool is_ready() const { return ready_; }
  void begin_handshake() {
    ready_ = false;
    stream_.emplace(std::move(waiting_), *server_.tls_);
    SecureContext::attach(stream_->native_handle(), &attached_);
    if (!server_.keys_->show(stream_->native_handle(), SecureContext::Own::kKey)) return end();
    stream_->async_handshake(ssl::stream_base::server,
                             guarded([this](TlsError error, std::size_t) { enter(error); }));
  }
  void end() {
    TlsError ignored;
    socket().close(ignored);
    inner_.close(ignored);
    ready_ = false;
  }
  bool is_open() const { return stream_ ? stream_->next_layer().is_open() : waiting_.is_open(); }
  bool has_entered() const { return speaker_.has_value(); }
  bool may_order() const { return speaker_ && speaker_->roles.has(Role::kOperator); }
  bool is_late(Nanos now) const { return now > deadline_; }
  Nanos since() const { return since_; }
  Nanos heard() const { return heard_; }
  const std::optional<Trusted>& speaker() const { return speaker_; }
  const PeerKey& shown() const { return attached_.peer; }
  const Address& from() const { return from_; }

 private:
  tcp::socket& socket() { return stream_ ? stream_->next_layer() : waiting_; }
  void limit_time() { deadline_ = monotonic_now() + kPatience; }

  // A ClientHello begins so (RFC 8446, 4.1.2 and 5.1), and is sent whole by whoever means it.
  void hear_hello(TlsError error) {
    std::array<std::uint8_t, 6> start{};
    const std::size_t size =
        error ? 0 : waiting_.receive(boost::asio::buffer(start), tcp::socket::message_peek, error);
    ready_ = !error && size == start.size() && start[0] == 0x16 && start[1] == 3 && start[5] == 1;
    if (ready_) return;
    server_.refused(*this);
    end();
  }
  void enter(TlsError error) {
    // The list may have changed since the key was looked at.
    const Trusted* who = server_.keys_->trusted().find(attached_.peer.key);
    if (error || who == nullptr || !who->roles.has_any(kOperators)) {
      server_.refused(*this);
      leave();
      return drain();
    }
    Local outer(inner_.get_executor());
    boost::asio::local::connect_pair(outer, inner_, error);
    if (error) return end();
    server_.make_room(kMostSessions, [](const Session& s) { return s.has_entered(); });
    settle_keys(server_.options_.keys, {attached_.own, attached_.peer.key});
    speaker_ = *who;
    deadline_ = kForever;
    server_.operators_.admit(std::move(outer), *speaker_);
    from_network();
    to_network();
  }
  void from_network() {
    stream_->async_read_some(boost::asio::buffer(up_),
                             guarded([this](TlsError error, std::size_t n) {
                               if (error) return end();
                               heard_ = monotonic_now();
                               if (leaving_) return from_network();
                               hand_on(n);
                             }));
  }
  void hand_on(std::size_t size) {
    boost::asio::async_write(inner_, boost::asio::buffer(up_, size),
                             guarded([this](TlsError error, std::size_t) {
                               // What is answered last still comes the other way.
                               if (error) leaving_ = true;
                               from_network();
                             }));
  }
  void to_network() {
    inner_.async_read_some(boost::asio::buffer(down_),
                           guarded([this](TlsError error, std::size_t n) {
                             if (error) return leave();
                             limit_time();
                             answer(n);
                           }));
  }
  void answer(std::size_t size) {
    boost::asio::async_write(*stream_, boost::asio::buffer(down_, size),
                             guarded([this](TlsError error, std::size_t) {
                               if (error) return end();
                               deadline_ = kForever;
                               to_network();
                             }));
  }
  // The other side is to have all that was answered before the connection is gone.
  void leave() {
    TlsError ignored;
    leaving_ = true;
    limit_time();
    socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  // Who was refused is to hear it: closed with bytes unread, a connection takes what was said last
  // with it.
  void drain() {
    socket().async_read_some(boost::asio::buffer(up_), guarded([this](TlsError error, std::size_t) {
                               return error ? end() : drain();
                             }));
  }

  RemoteOperatorServer& server_;
  SecureContext::Attached attached_;
  tcp::socket waiting_;  // until its handshake begins
  std::optional<ssl::stream<tcp::socket>> stream_;
  Local inner_;  // the OperatorServer has the other end
  Address from_;
  std::optional<Trusted> speaker_;  // once a key has been shown
  bool ready_ = false;              // its ClientHello is here
  Nanos since_ = 0;                 // it has come
  Nanos heard_ = 0;                 // newest bytes
  Nanos deadline_ = kForever;
  bool leaving_ = false;
  std::array<char, 4096> up_{}, down_{};
};

RemoteOperatorServer::RemoteOperatorServer(boost::asio::io_context& io, OperatorServer& operators)
    : operators_(operators), acceptor_(io) {}

RemoteOperatorServer::~RemoteOperatorServer() { close(); }

Status RemoteOperatorServer::open(const RemoteOperatorOptions& options) {
  close();
  auto keys =
      SecureContext::make(options.keys.own.key, options.keys.trusted, SecureContext::Side::kServer,
                          kOperators, SecureContext::Over::kStream);
  if (!keys) return keys.status();
  keys_ = std::move(*keys);
  const OwnEntry& own = options.keys.own;
  if (Status set = keys_->set_own(own.key, own.next); !set) return set;
  SSL_CTX_up_ref(keys_->get());  // the other's reference
  tls_ = std::make_unique<ssl::context>(keys_->get());
  options_ = options;
  return open_own(acceptor_, {"operator", "set operator_port", options.address, options.port});
}

std::string RemoteOperatorServer::place() const {
  TlsError closed;
  const tcp::endpoint own = acceptor_.local_endpoint(closed);
  if (closed) return {};
  const std::string port = ":" + std::to_string(own.port());
  if (options_.address == "any") return "any" + port;
  const std::string ip = own.address().to_string();
  return own.address().is_v6() ? "[" + ip + "]" + port : ip + port;
}

void RemoteOperatorServer::tick(Nanos now) {
  if (!acceptor_.is_open()) return;
  if (refill_ == 0) say_trusted();
  if (now >= refill_) {
    refill_ = now + kSecond;
    handshakes_.clear();
  }
  for (const auto& session : sessions_) {
    if (session->is_late(now)) session->end();
  }
  std::erase_if(sessions_, [](const auto& session) { return !session->is_open(); });
  follow_keys(options_.keys, now, changes_);
  accept();
  begin_handshake();
}

void RemoteOperatorServer::take_trusted(const TrustList& trusted) {
  keys_->set_trusted(trusted);
  say_trusted();
  for (const auto& session : sessions_) {
    if (!session->has_entered()) continue;
    const Trusted* now_trusted = trusted.find(session->shown().key);
    const bool same = now_trusted != nullptr && now_trusted->name == session->speaker()->name &&
                      now_trusted->roles == session->speaker()->roles;
    if (!same) session->end();
  }
}

void RemoteOperatorServer::say_trusted() const {
  const std::string those = those_trusted(keys_->trusted(), kOperators);
  const bool nobody = those == "nobody";
  say(nobody, "keys: trusted as operator or observer: " + those +
                  (nobody ? "; `handrail keys show` there prints the line to type here" : ""));
}

void RemoteOperatorServer::accept() {
  for (int i = 0; i < kMostAccepted; ++i) {
    TlsError error;
    tcp::socket socket = acceptor_.accept(error);
    if (error) return;  // nobody waits, or no descriptor is left for who does
    const auto session = std::make_shared<Session>(std::move(socket), *this);
    session->begin();
    const auto stranger = [](const Session& s) { return !s.has_entered(); };
    make_room(kMostOfOneNetwork, [&](const Session& s) {
      return stranger(s) && network_of(s.from()) == network_of(session->from());
    });
    make_room(kMostStrangers, stranger);
    sessions_.push_back(session);
  }
}

void RemoteOperatorServer::begin_handshake() {
  if (handshakes_.size() >= kHandshakesPerSecond) return;
  const auto rank = [this](const Session& s) {
    const auto of_network =
        std::count(handshakes_.begin(), handshakes_.end(), network_of(s.from()));
    return std::tuple(!s.is_ready(), of_network, s.since());
  };
  const auto next =
      std::min_element(sessions_.begin(), sessions_.end(),
                       [&](const auto& a, const auto& b) { return rank(*a) < rank(*b); });
  if (next == sessions_.end() || !(*next)->is_ready()) return;
  handshakes_.push_back(network_of((*next)->from()));
  (*next)->begin_handshake();
}

template <typename Counts>
void RemoteOperatorServer::make_room(std::size_t most, Counts counts) {
  std::size_t number = 0;
  std::shared_ptr<Session> first;
  for (const auto& session : sessions_) {
    if (!session->is_open() || !counts(*session)) continue;
    ++number;
    const auto rank = [](const Session& s) { return std::pair(s.may_order(), s.heard()); };
    if (!first || rank(*session) < rank(*first)) first = session;
  }
  if (number >= most) first->end();
}

void RemoteOperatorServer::refused(const Session& session) {
  const Nanos now = monotonic_now();
  if (now < next_line_) return;
  next_line_ = now + kLinePause;
  if (session.shown().shown) {
    const LinkProblem problem =
        problem_of(DtlsChannel::Problem::kUntrusted, session.shown(), session.from(),
                   keys_->trusted(), options_.keys.own.entry(), {Role::kMaster, Role::kOperator});
    say(true, "refused: " + problem.text());
  } else {
    say(true, "refused: what is at " + address_text(session.from()) +
                  " shows no key over TLS 1.3 on the operators' port, as `handrail --master` does");
  }
}

void RemoteOperatorServer::close() {
  TlsError ignored;
  acceptor_.close(ignored);
  for (const auto& session : sessions_) session->end();
  sessions_.clear();
  refill_ = 0;
}

std::size_t RemoteOperatorServer::sessions() const {
  return static_cast<std::size_t>(
      std::count_if(sessions_.begin(), sessions_.end(),
                    [](const auto& s) { return s->is_open() && s->has_entered(); }));
}

}  // namespace handrail
