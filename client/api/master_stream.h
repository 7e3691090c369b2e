// Bytes to a master, or another program's socket on this computer, and back, waited for.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>

#include "client/api/master_place.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

// One connection, each of whose calls ends by its deadline [monotonic], or soon after `cancelled`
// says so. An error names the master's place and the cause. After one it is of no more use. Not
// thread-safe.
class MasterStream {
 public:
  using Cancelled = bool (*)();
  using Done = std::function<void(boost::system::error_code, std::size_t)>;

  virtual ~MasterStream() = default;
  virtual Status connect(Nanos deadline) = 0;
  // The first reply has come.
  virtual void was_answered() {}
  // After an error: nothing that was said was heard, for the key that was shown; another one of
  // ours may be let in.
  virtual bool wants_other_key() const { return false; }
  Status write(const std::string& bytes, Nanos deadline);
  Status read(boost::asio::mutable_buffer to, Nanos deadline);  // all of it
  // Sends a message, and waits for the one that answers it (server/base/length_prefix.h).
  Result<std::string> ask(const std::string& message, Nanos deadline);

  Status failure(const std::string& what) const { return Status::error(place_ + ": " + what); }

 protected:
  // `place`: as name_of() says. `cancelled` null: never.
  MasterStream(std::string place, Cancelled cancelled)
      : place_(std::move(place)), cancelled_(cancelled) {}

  bool is_cancelled() const { return cancelled_ != nullptr && cancelled_(); }
  // Runs the connection until what `start` begins has ended, which tells the function it is given.
  // Neither in time nor cancelled: what it ended with is `ended`, and the result is good.
  Status await(Nanos deadline, const std::function<void(Done)>& start,
               boost::system::error_code& ended);

  virtual void begin_write(boost::asio::const_buffer bytes, Done done) = 0;
  virtual void begin_read(boost::asio::mutable_buffer to, Done done) = 0;
  virtual void close() noexcept = 0;  // ends what was begun
  // What a person is told of an error of the connection.
  virtual std::string text_of(const boost::system::error_code& error) const;

  boost::asio::io_context io_;
  const std::string place_;

 private:
  Status settled(Nanos deadline, const std::function<void(Done)>& start);

  Cancelled cancelled_;
};

// Whose socket on this computer, for people.
struct SocketWords {
  std::string place;  // how an error begins
  std::string start;  // how it ends where nobody serves the socket
};

// Not connected. `with_next`: with the key that is to take the place of ours, if there is one.
// Throws boost::system::system_error where no descriptors are left.
std::unique_ptr<MasterStream> make_socket_stream(const std::string& path, SocketWords words,
                                                 MasterStream::Cancelled cancelled);
std::unique_ptr<MasterStream> make_tls_stream(const MasterPlace& place,
                                              MasterStream::Cancelled cancelled, bool with_next);

}  // namespace handrail
