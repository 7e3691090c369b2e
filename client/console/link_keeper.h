// The file of links, read and written in a thread of its own: no page waits for the disk.
#pragma once

#include <functional>
#include <string>
#include <vector>

// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <utility>

#include "server/keys/once_links.h"

namespace handrail {

class LinkKeeper {
 public:
  // Who removes a link waits so long for the end of its session.
  static constexpr int kLookMs = 500;

  // `io` must outlive it; what comes is told in its thread.
  LinkKeeper(boost::asio::io_context& io, OnceLinks links);
  ~LinkKeeper();

  using Told = std::function<void(const Result<OnceLinks::Taken>&)>;
  void take(std::string token, Told told);

  // The links that there are: soon, and whenever the file has changed; an error once.
  using Changed = std::function<void(const Result<std::vector<OnceLink>>&)>;
  void watch(Changed changed);

 private:
  void look_later();

  boost::asio::io_context& io_;
  const OnceLinks links_;
  boost::asio::steady_timer timer_;
  Changed changed_;
  std::string known_ = "?";
  boost::asio::thread_pool pool_{1};
};

}  // namespace handrail
