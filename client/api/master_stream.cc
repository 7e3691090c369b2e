#include "client/api/master_stream.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>

#include "server/base/clock.h"
#include "server/base/length_prefix.h"

namespace handrail {
namespace {

// Between two looks whether the call is cancelled: Ctrl-C feels immediate.
constexpr Nanos kLook = 50 * kMillisecond;

}  // namespace

Status MasterStream::await(Nanos deadline, const std::function<void(Done)>& start,
                           boost::system::error_code& ended) {
  std::optional<boost::system::error_code> result;
  start([&result](boost::system::error_code error, std::size_t) { result = error; });
  std::string gave_up;
  while (!result) {
    const Nanos left = deadline - monotonic_now();
    if (gave_up.empty()) {
      if (left <= 0) gave_up = "no answer in time";
      if (is_cancelled()) gave_up = "interrupted";
      if (!gave_up.empty()) close();
    }
    io_.restart();
    // Asio runs nothing at all in a time of zero, not even what is ready.
    io_.run_one_for(std::chrono::nanoseconds(std::clamp<Nanos>(left, kMillisecond, kLook)));
  }
  if (!gave_up.empty()) return failure(gave_up);
  ended = *result;
  return Status::ok();
}

Status MasterStream::settled(Nanos deadline, const std::function<void(Done)>& start) {
  boost::system::error_code ended;
  if (Status status = await(deadline, start, ended); !status) return status;
  return ended ? failure(text_of(ended)) : Status::ok();
}

Status MasterStream::write(const std::string& bytes, Nanos deadline) {
  return settled(deadline,
                 [&](Done done) { begin_write(boost::asio::buffer(bytes), std::move(done)); });
}

Status MasterStream::read(boost::asio::mutable_buffer to, Nanos deadline) {
  return settled(deadline, [&](Done done) { begin_read(to, std::move(done)); });
}

Result<std::string> MasterStream::ask(const std::string& message, Nanos deadline) {
  // A peer that refuses the connection answers and closes, perhaps before the message is out.
  const Status sent = write(framed(message), deadline);
  std::array<char, kFrameHeader> header{};
  if (Status s = read(boost::asio::buffer(header), deadline); !s) return sent ? s : sent;
  const std::uint32_t size = frame_size(header.data());
  if (size > kMaxFrame) return failure("the reply is larger than 64 KiB");
  std::string body(size, '\0');
  if (Status s = read(boost::asio::buffer(body), deadline); !s) return s;
  return body;
}

std::string MasterStream::text_of(const boost::system::error_code& error) const {
  namespace e = boost::asio::error;
  const bool closed = error == e::eof || error == e::broken_pipe || error == e::connection_reset;
  return closed ? "it closed the connection" : error.message();
}

}  // namespace handrail
