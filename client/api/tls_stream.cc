// A master on another computer: TLS 1.3 over TCP, with this user's key.
#include "client/api/master_stream.h"

#include <openssl/err.h>
#include <openssl/ssl.h>

#include <chrono>
#include <future>
#include <optional>
#include <thread>
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/error.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/write.hpp>

#include "server/base/clock.h"
#include "server/keys/host_port.h"
#include "server/keys/key_folder.h"
#include "server/link/secure/peer_resolver.h"
#include "server/link/secure/secure_context.h"
#include "server/link/secure/secure_text.h"
#include "server/link/secure/udp_socket.h"

namespace handrail {
namespace {

namespace ssl = boost::asio::ssl;
using boost::asio::ip::tcp;
using boost::system::error_code;
using Endpoints = std::vector<tcp::endpoint>;

// Between two looks whether the call is cancelled.
constexpr auto kLookUpLook = std::chrono::milliseconds(50);

class TlsStream final : public MasterStream {
 public:
  TlsStream(const MasterPlace& place, Cancelled cancelled, bool with_next)
      : MasterStream(name_of(place), cancelled), host_(place.host), with_next_(with_next) {}

  Status connect(Nanos deadline) override;
  void was_answered() override;
  bool wants_other_key() const override {
    return refused_ && attached_.own != own_->key.public_key();
  }

 private:
  using Stream = ssl::stream<tcp::socket>;

  void begin_write(boost::asio::const_buffer bytes, Done done) override {
    boost::asio::async_write(*stream_, bytes, std::move(done));
  }
  void begin_read(boost::asio::mutable_buffer to, Done done) override {
    boost::asio::async_read(*stream_, to, std::move(done));
  }
  void close() noexcept override {
    error_code ignored;
    if (stream_) stream_->next_layer().close(ignored);
  }
  std::string text_of(const error_code& error) const override;

  Status take_keys();
  Result<Endpoints> look_up(const HostPort& where, Nanos deadline) const;
  Status reach(const Endpoints& endpoints, Nanos deadline);
  Status greet(Nanos deadline);
  std::string problem_with(DtlsChannel::Problem problem) const;

  const std::string host_;
  const bool with_next_;
  const KeyFolder folder_{default_key_folder()};
  std::optional<OwnEntry> own_;
  std::unique_ptr<SecureContext> keys_;
  std::optional<ssl::context> tls_;
  SecureContext::Attached attached_;
  std::unique_ptr<Stream> stream_;
  bool told_ = false;             // the folder, of the session
  mutable bool refused_ = false;  // our key is not trusted there
};

Status TlsStream::connect(Nanos deadline) {
  const auto where = parse_host(host_, kOperatorPort);
  if (!where) return failure(where.message());
  if (Status status = take_keys(); !status) return status;
  const auto endpoints = look_up(*where, deadline);
  if (!endpoints) return endpoints.status();
  if (Status status = reach(*endpoints, deadline); !status) return status;
  return greet(deadline);
}

Status TlsStream::take_keys() {
  const auto own = folder_.load();
  if (!own) return failure("it is reached with a key of yours: " + own.message());
  const auto trusted = folder_.trusted();
  if (!trusted) return failure(trusted.message());
  auto keys = SecureContext::make(own->key, *trusted, SecureContext::Side::kClient, Role::kMaster,
                                  SecureContext::Over::kStream);
  if (!keys) return failure(keys.message());
  own_ = *own;
  keys_ = std::move(*keys);
  if (Status set = keys_->set_own(own->key, own->next); !set) return failure(set.message());
  SSL_CTX_up_ref(keys_->get());  // the other's reference
  tls_.emplace(keys_->get());
  return Status::ok();
}

Result<Endpoints> TlsStream::look_up(const HostPort& where, Nanos deadline) const {
  // The system's resolver may wait for many seconds and cannot be told to end: its thread is left
  // behind then.
  std::packaged_task<Result<Endpoints>()> question([where]() -> Result<Endpoints> {
    boost::asio::io_context io;
    error_code error;
    const auto found = tcp::resolver(io).resolve(where.host, std::to_string(where.port),
                                                 tcp::resolver::numeric_service, error);
    if (error) return Status::error("'" + where.host + "' has no address: " + error.message());
    Endpoints out;
    for (const auto& entry : found) out.push_back(entry.endpoint());
    return out;
  });
  auto answer = question.get_future();
  std::thread(std::move(question)).detach();
  while (answer.wait_for(kLookUpLook) != std::future_status::ready) {
    if (is_cancelled()) return failure("interrupted");
    if (monotonic_now() >= deadline) {
      return failure("no address of '" + where.host + "' in time: does a name server answer?");
    }
  }
  Result<Endpoints> found = answer.get();
  return found ? found : failure(found.message());
}

Status TlsStream::reach(const Endpoints& endpoints, Nanos deadline) {
  Status last = failure("it has no address");
  for (const tcp::endpoint& to : endpoints) {
    attached_ = {};
    attached_.address = address_of({to.address(), to.port()});
    stream_ = std::make_unique<Stream>(io_, *tls_);
    SecureContext::attach(stream_->native_handle(), &attached_);
    const auto shown = with_next_ ? SecureContext::Own::kNext : SecureContext::Own::kKey;
    if (!keys_->show(stream_->native_handle(), shown)) return failure("no memory for a key");
    error_code error;
    const Status in_time = await(
        deadline,
        [&](Done done) {
          stream_->next_layer().async_connect(to, [done](error_code e) { done(e, 0); });
        },
        error);
    const std::string place = address_text(attached_.address);
    if (!in_time) {
      return failure("no answer from " + place +
                     ": is a master started there with --operators any, and does TCP port " +
                     std::to_string(to.port()) + " pass every firewall on the way?");
    }
    if (!error) {
      stream_->next_layer().set_option(tcp::no_delay(true), error);
      return Status::ok();
    }
    last = failure(error == boost::asio::error::connection_refused
                       ? "nobody listens at " + place +
                             ": start handrail-master with --operators any there"
                       : place + ": " + error.message());
  }
  return last;
}

Status TlsStream::greet(Nanos deadline) {
  error_code error;
  Status in_time = await(
      deadline,
      [&](Done done) {
        stream_->async_handshake(ssl::stream_base::client, [done](error_code e) { done(e, 0); });
      },
      error);
  if (!in_time) return in_time;
  return error ? failure(text_of(error)) : Status::ok();
}

void TlsStream::was_answered() {
  if (std::exchange(told_, true)) return;
  const Trusted* who = keys_->trusted().find(attached_.peer.key);
  const bool settles =
      own_->next || (who != nullptr && who->next == std::optional(attached_.peer.key));
  // What cannot be written now is settled by a later session.
  if (settles) (void)folder_.confirm(attached_.own, attached_.peer.key);
}

std::string TlsStream::problem_with(DtlsChannel::Problem problem) const {
  const bool observer = own_->roles.has(Role::kObserver) && !own_->roles.has(Role::kOperator);
  return problem_of(problem, attached_.peer, attached_.address, keys_->trusted(), own_->entry(),
                    {observer ? Role::kObserver : Role::kOperator, Role::kMaster})
      .text();
}

std::string TlsStream::text_of(const error_code& error) const {
  if (attached_.peer.shown && !attached_.peer.trusted) {
    return problem_with(DtlsChannel::Problem::kUntrusted);
  }
  if (error == ssl::error::stream_truncated) return "it closed the connection";
  if (error.category() != boost::asio::error::get_ssl_category()) {
    return MasterStream::text_of(error);
  }
  if (ERR_GET_REASON(static_cast<unsigned long>(error.value())) ==
      SSL_R_SSLV3_ALERT_BAD_CERTIFICATE) {
    refused_ = true;
    return problem_with(DtlsChannel::Problem::kWeAre);
  }
  return "what is at " + address_text(attached_.address) +
         " does not agree on TLS 1.3 with keys of P-256: expected the operator port of a "
         "handrail-master of this version; " +
         error.message();
}

}  // namespace

std::unique_ptr<MasterStream> make_tls_stream(const MasterPlace& place,
                                              MasterStream::Cancelled cancelled, bool with_next) {
  return std::make_unique<TlsStream>(place, cancelled, with_next);
}

}  // namespace handrail
