// Whether our key or the list of the trusted has changed on the disk, without waiting for the disk.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/base/time.h"
#include "server/daemon/errand.h"
#include "server/keys/key_folder.h"
#include "server/link/secure/secure_context.h"

namespace handrail {

class KeyWatch {
 public:
  // Who removes a key waits so long for the end of its session.
  static constexpr Nanos kLook = 500 * kMillisecond;

  // What has changed since it was read last, each by itself: a key that cannot be read keeps no
  // removal from taking place.
  struct News {
    Status settled = Status::ok();  // what sessions have settled could be written
    std::optional<Result<OwnEntry>> own;
    std::optional<Result<TrustList>> trusted;
  };

  // `known`: the folder's stamp when it was read last.
  KeyWatch(KeyFolder folder, std::string known)
      : folder_(std::move(folder)), known_(std::move(known)) {}

  // A session serves both ways: what this settles about keys that change is written aside.
  void begun(const SessionKeys& keys) { begun_.push_back(keys); }

  // Once for each change; an error is of the looking itself. Never waits.
  std::optional<Result<News>> poll(Nanos now) {
    if (!under_way_ && now < next_ && begun_.empty()) return std::nullopt;
    const auto looked = errand_.poll(under_way_ ? Work() : work());
    under_way_ = !looked.has_value();
    if (!looked) return std::nullopt;
    next_ = now + kLook;
    if (!*looked) return Result<News>(looked->status());
    known_ = (*looked)->stamp;
    const News& news = (*looked)->news;
    if (news.settled && !news.own && !news.trusted) return std::nullopt;
    return Result<News>(news);
  }

 private:
  struct Look {
    std::string stamp;
    News news;
  };
  using Work = std::function<Result<Look>()>;

  Work work() {
    return [folder = folder_, known = known_, begun = std::exchange(begun_, {})]() -> Result<Look> {
      Look out;
      for (const SessionKeys& keys : begun) {
        if (Status done = folder.confirm(keys.ours, keys.theirs); !done) out.news.settled = done;
      }
      // The stamp first: a change between the two is seen next time.
      out.stamp = folder.stamp();
      if (out.stamp == known) return out;
      out.news.own = folder.load();
      out.news.trusted = folder.trusted();
      return out;
    };
  }

  KeyFolder folder_;
  std::string known_;
  Nanos next_ = -kForever;
  bool under_way_ = false;
  std::vector<SessionKeys> begun_;
  Errand<Result<Look>> errand_;
};

}  // namespace handrail
