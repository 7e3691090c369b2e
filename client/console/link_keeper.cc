#include "client/console/link_keeper.h"

#include <chrono>
#include <ctime>

#include <boost/asio/post.hpp>

namespace handrail {

namespace asio = boost::asio;

LinkKeeper::LinkKeeper(asio::io_context& io, OnceLinks links)
    : io_(io), links_(std::move(links)), timer_(io) {}

LinkKeeper::~LinkKeeper() {
  timer_.cancel();
  pool_.join();
}

void LinkKeeper::take(std::string token, Told told) {
  asio::post(pool_, [this, token = std::move(token), told = std::move(told)] {
    const auto taken = links_.take(token, std::time(nullptr));
    asio::post(io_, [taken, told] { told(taken); });
  });
}

void LinkKeeper::watch(Changed changed) {
  changed_ = std::move(changed);
  look_later();
}

void LinkKeeper::look_later() {
  timer_.expires_after(std::chrono::milliseconds(kLookMs));
  timer_.async_wait([this](const boost::system::error_code& ended) {
    if (ended) return;
    asio::post(pool_, [this, known = known_] {
      // The stamp first: a change between the two is seen next time.
      const std::string now = links_.stamp();
      auto links = now == known ? Result<std::vector<OnceLink>>(std::vector<OnceLink>())
                                : links_.list(std::time(nullptr));
      asio::post(io_, [this, now, known, links = std::move(links)] {
        known_ = now;
        if (now != known) changed_(links);
        look_later();
      });
    });
  });
}

}  // namespace handrail
